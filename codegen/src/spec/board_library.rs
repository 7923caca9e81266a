//! The library of boards, from the folder `boards`.

/// A board of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LibraryBoard {
    /// Its name: the file's, without ending.
    pub name: &'static str,
    /// The text of its file.
    pub text: &'static str,
}

/// The library in the order of its names, from the folder `boards`.
pub const BOARDS: [LibraryBoard; 7] = [
    board("hoverboard", include_str!("../../boards/hoverboard.toml")),
    board("odrive-v3", include_str!("../../boards/odrive-v3.toml")),
    board(
        "st-b-g431b-esc1",
        include_str!("../../boards/st-b-g431b-esc1.toml"),
    ),
    board(
        "st-x-nucleo-ihm08m1",
        include_str!("../../boards/st-x-nucleo-ihm08m1.toml"),
    ),
    board(
        "st-x-nucleo-ihm16m1",
        include_str!("../../boards/st-x-nucleo-ihm16m1.toml"),
    ),
    board("vesc-4", include_str!("../../boards/vesc-4.toml")),
    board("vesc-75-300", include_str!("../../boards/vesc-75-300.toml")),
];

const fn board(name: &'static str, text: &'static str) -> LibraryBoard {
    LibraryBoard { name, text }
}

/// A library's board, as messages name it: whoever reads them has no file of it.
pub(super) fn file_of(name: &str) -> String {
    format!("board {name}")
}

/// The file of a board, as messages name it; none of a name that the library does not have.
pub(super) fn library_file(name: &str) -> Option<String> {
    let known = BOARDS.iter().any(|board| board.name == name);
    known.then(|| file_of(name))
}
