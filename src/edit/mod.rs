//! Which command a key means, and the history of commands.
