//! What a session is exchanged over, and how it may break.

/// Input and output of a session.
pub trait Link {
    /// Fills the front of `bytes`; returns how many, fewer than requested only at the end of the
    /// input.
    ///
    /// # Errors
    /// If the input cannot be read.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Broken>;

    /// Writes all bytes.
    ///
    /// # Errors
    /// If the output cannot be written.
    fn write(&mut self, bytes: &[u8]) -> Result<(), Broken>;
}

/// The exchange ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Broken {
    /// Input or output failed.
    Link,
    /// The input is not a task or record.
    Format,
    /// Instructions cannot be counted here: the session does not run on a core of its own.
    Uncounted,
}
