//! Arguments -> exit code: parses, runs, maps errors.

fn main() {}
