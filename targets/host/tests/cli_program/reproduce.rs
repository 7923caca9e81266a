//! `hexagen reproduce`, from its arguments to its page.

use crate::support::run;

#[test]
fn experiment_runs_and_leaves_its_page() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().to_str().expect("a path of text");
    let said = run(["reproduce", "--out", out]);
    assert_eq!(said.code, 0, "{said:?}");
    for text in [
        "(a) rated torque",
        "(h) ",
        "holds in part",
        "does not hold",
        "T_f",
    ] {
        assert!(
            said.stdout.contains(text),
            "no `{text}` in\n{}",
            said.stdout
        );
    }
    assert!(said.stderr.contains("simulating …\n"), "{said:?}");
    let page = folder.path().join("reproduction.html");
    let last = said.stdout.lines().last();
    assert_eq!(last, Some(format!("Page: {}", page.display()).as_str()));
    let html = std::fs::read_to_string(&page).expect("the page is there");
    assert!(html.contains("<section id=\"figure-20\">") && html.ends_with("</html>"));
}

#[test]
fn folder_that_cannot_be_made_is_told_before_the_work() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("can be written");
    let out = file.to_str().expect("a path of text");
    let said = run(["reproduce", "--out", out]);
    said.assert_bad_input(&["cannot write", out]);
    run(["reproduce", "--speed", "1"]).assert_bad_input(&["--speed"]);
}
