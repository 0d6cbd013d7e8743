//! `judge`: a request on standard input, its verdict on standard output. Exit code 2 and a line of why where there is none.

use std::io::{Read, Write, stdin, stdout};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut request = vec![];
    let answered = stdin()
        .read_to_end(&mut request)
        .map_err(anyhow::Error::from)
        .and_then(|_| judge::verdict(&request))
        .and_then(|verdict| Ok(stdout().write_all(&verdict)?));
    match answered {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::from(2)
        }
    }
}
