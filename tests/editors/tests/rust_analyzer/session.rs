//! A session with rust-analyzer: the editor's side, with one open file.

use lsp_server::{ErrorCode, Message, Notification, Request, Response, ResponseError};
use lsp_types::{
    Contents, Definition, DefinitionParams, DefinitionRequest, DefinitionResponse, Diagnostic,
    DocumentDiagnosticParams, DocumentDiagnosticReport, DocumentDiagnosticRequest, HoverParams,
    HoverRequest, Location, Position, TextDocumentIdentifier, TextDocumentPositionParams,
};
use serde_json::{Value, json};
use std::fs;
use std::io::{BufReader, Read as _};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{JoinHandle, spawn};
use std::time::Duration;

/// The language server of the toolchain.
const SERVER: &str = "rust-analyzer";

/// Longest wait for a message. The server is silent while cargo builds the macros.
const PATIENCE: Duration = Duration::from_secs(900);

/// The editor's side of a session.
pub struct Session {
    server: Child,
    input: ChildStdin,
    messages: Receiver<Message>,
    complaints: JoinHandle<String>,
    last_request: i32,
    document: TextDocumentIdentifier,
    version: i32,
    /// The open file's text as the editor shows it, which is not saved.
    text: String,
}

impl Session {
    /// Starts the server on the crate in `folder`, opens `src/lib.rs` and waits until the macros
    /// are built.
    pub fn begin(folder: &Path) -> Self {
        let mut server = Command::new(SERVER)
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("{SERVER}: {error}"));
        let input = server.stdin.take().expect("is piped");
        let mut output = BufReader::new(server.stdout.take().expect("is piped"));
        let mut errors = server.stderr.take().expect("is piped");
        let (sender, messages) = channel();
        spawn(move || {
            while let Ok(Some(message)) = Message::read(&mut output) {
                if sender.send(message).is_err() {
                    break;
                }
            }
        });
        let complaints = spawn(move || {
            let mut text = vec![];
            // What was read until the server ended counts.
            let _ = errors.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        let file = folder.join("src/lib.rs");
        let text = fs::read_to_string(&file).expect("the crate has this file");
        let mut session = Self {
            server,
            input,
            messages,
            complaints,
            last_request: 0,
            document: TextDocumentIdentifier::new(address(&file).as_str().into()),
            version: 1,
            text,
        };
        session.initialize(folder);
        session
    }

    fn initialize(&mut self, folder: &Path) {
        self.ask(
            "initialize",
            &json!({
                "processId": std::process::id(),
                "rootUri": address(folder),
                "capabilities": {
                    "textDocument": {
                        "hover": { "contentFormat": ["markdown"] },
                        "diagnostic": {},
                    },
                    "experimental": { "serverStatusNotification": true },
                },
                // Errors are to come from the expansion alone, not from `cargo check`.
                "initializationOptions": { "checkOnSave": false, "cachePriming": { "enable": false } },
            }),
        )
        .expect("the session begins");
        self.tell("initialized", &json!({}));
        let document = json!({
            "uri": self.document.uri, "languageId": "rust", "version": 1, "text": self.text,
        });
        self.tell("textDocument/didOpen", &json!({ "textDocument": document }));
        self.wait_until_ready();
    }

    /// Waits until the server has nothing left to load and build.
    fn wait_until_ready(&mut self) {
        loop {
            let Message::Notification(Notification { method, params }) = self.receive() else {
                continue;
            };
            if method == "experimental/serverStatus" && params["quiescent"] == true {
                assert_eq!(params["health"], "ok", "{params}");
                return;
            }
        }
    }

    /// What the editor shows where the pointer rests on the first `text` behind `before`.
    pub fn hover(&mut self, before: &str, text: &str) -> String {
        let at = self.place(before, text);
        let hover = self.request::<HoverRequest>(HoverParams::new(<_>::default(), at));
        match hover.map(|hover| hover.contents) {
            Some(Contents::MarkupContent(content)) => content.value,
            other => panic!("nothing to show on `{text}`: {other:?}"),
        }
    }

    /// Where the editor goes from the first `text` behind `before`.
    pub fn definitions(&mut self, before: &str, text: &str) -> Vec<Location> {
        let at = self.place(before, text);
        let parameters = DefinitionParams::new(<_>::default(), <_>::default(), at);
        match self.request::<DefinitionRequest>(parameters) {
            Some(DefinitionResponse::Definition(Definition::Location(place))) => vec![place],
            Some(DefinitionResponse::Definition(Definition::LocationList(places))) => places,
            other => panic!("no definition of `{text}`: {other:?}"),
        }
    }

    /// Errors and warnings in the open file.
    pub fn diagnostics(&mut self) -> Vec<Diagnostic> {
        let parameters = DocumentDiagnosticParams::new(
            self.document.clone(),
            None,
            None,
            <_>::default(),
            <_>::default(),
        );
        let report = self.request::<DocumentDiagnosticRequest>(parameters);
        let DocumentDiagnosticReport::RelatedFullDocumentDiagnosticReport(report) = report else {
            panic!("nothing to compare with was named: {report:?}");
        };
        report.full_document_diagnostic_report.items
    }

    /// Types `new` in place of the first `old`, without saving.
    pub fn replace(&mut self, old: &str, new: &str) {
        assert!(self.text.contains(old), "the file has no `{old}`");
        self.text = self.text.replacen(old, new, 1);
        self.version += 1;
        let document = json!({ "uri": self.document.uri, "version": self.version });
        let changes = json!([{ "text": self.text }]);
        self.tell(
            "textDocument/didChange",
            &json!({ "textDocument": document, "contentChanges": changes }),
        );
    }

    /// Line and column, from 0, of the first `text` behind the first `before`.
    pub fn position(&self, before: &str, text: &str) -> Position {
        let behind = self.text.find(before).map(|at| at + before.len());
        let found = behind.and_then(|from| Some(from + self.text[from..].find(text)?));
        let at = found.unwrap_or_else(|| panic!("the file has no `{text}` behind `{before}`"));
        let lines: Vec<&str> = self.text[..at].split('\n').collect();
        let column = lines.last().map_or(0, |line| line.len());
        Position::new((lines.len() - 1) as u32, column as u32)
    }

    /// The address of the open file.
    pub fn file(&self) -> &str {
        self.document.uri.as_ref()
    }

    /// Ends the session. Returns what the server wrote to its standard error.
    pub fn end(mut self) -> String {
        self.ask("shutdown", &Value::Null)
            .expect("the session ends");
        self.tell("exit", &Value::Null);
        let status = self.server.wait().expect("the server ran");
        assert!(status.success(), "rust-analyzer ended with {status}");
        self.complaints.join().expect("the reader does not panic")
    }

    fn place(&self, before: &str, text: &str) -> TextDocumentPositionParams {
        TextDocumentPositionParams::new(self.document.clone(), self.position(before, text))
    }

    fn request<R: lsp_types::Request>(&mut self, parameters: R::Params) -> R::Result {
        let method = R::METHOD.to_string();
        let parameters = serde_json::to_value(parameters).expect("parameters are JSON");
        let result = self
            .ask(&method, &parameters)
            .unwrap_or_else(|error| panic!("{method}: {}", error.message));
        serde_json::from_value(result).expect("the protocol says what the result is")
    }

    /// Sends a request, and waits for its result.
    fn ask(&mut self, method: &str, parameters: &Value) -> Result<Value, ResponseError> {
        loop {
            self.last_request += 1;
            let id = self.last_request;
            let request = Request::new(id.into(), method.to_owned(), parameters);
            self.send(&request.into());
            let result = loop {
                if let Message::Response(response) = self.receive()
                    && response.id == id.into()
                {
                    break response.response_result;
                }
            };
            // The server asks to repeat what a change overtook.
            let is_overtaken = |error: &ResponseError| {
                [ErrorCode::ContentModified, ErrorCode::ServerCancelled]
                    .iter()
                    .any(|code| error.code == *code as i32)
            };
            if !result.as_ref().is_err_and(is_overtaken) {
                return result;
            }
        }
    }

    fn tell(&mut self, method: &str, parameters: &Value) {
        self.send(&Notification::new(method.to_owned(), parameters).into());
    }

    fn send(&mut self, message: &Message) {
        message
            .write(&mut self.input)
            .expect("the server takes messages");
    }

    /// The next message. What the server asks of the editor, as to show progress, is granted.
    fn receive(&mut self) -> Message {
        let message = self
            .messages
            .recv_timeout(PATIENCE)
            .expect("the server sends messages");
        if let Message::Request(request) = &message {
            self.send(&Response::new_ok(request.id.clone(), Value::Null).into());
        }
        message
    }
}

/// The address of a file or folder.
fn address(path: &Path) -> String {
    format!("file://{}", path.display())
}
