//! The emulator's access to files of the host: semihosting.

use crate::drives::Drives;
use crate::link::{Broken, Link};
use crate::session::serve;
use semihosting::fs::File;
use semihosting::io::{Read, Write};
use semihosting::{eprintln, process};

struct Files {
    task: File,
    answers: File,
}

impl Link for Files {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Broken> {
        let mut filled = 0;
        while let Some(rest) = bytes.get_mut(filled..)
            && !rest.is_empty()
        {
            match self.task.read(rest).map_err(|_| Broken::Link)? {
                0 => break,
                more => filled += more,
            }
        }
        Ok(filled)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Broken> {
        self.answers.write_all(bytes).map_err(|_| Broken::Link)
    }
}

/// Serves the task in the file `task` of the emulator's folder, writes the file `answers`, and ends
/// the emulator.
pub fn run(drives: Drives) -> ! {
    run_with(|link| serve(link, drives))
}

/// Like [`run`], with another server.
pub fn run_with(serve: impl FnOnce(&mut dyn Link) -> Result<(), Broken>) -> ! {
    let files = (File::open(c"task"), File::create(c"answers"));
    let outcome = match files {
        (Ok(task), Ok(answers)) => serve(&mut Files { task, answers }),
        _ => Err(Broken::Link),
    };
    match outcome {
        Ok(()) => process::exit(0),
        Err(broken) => {
            eprintln!("the exchange failed: {broken:?}");
            process::exit(1)
        }
    }
}
