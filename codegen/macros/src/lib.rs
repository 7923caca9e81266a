//! The procedural macros of hexagen: forwarding only.
