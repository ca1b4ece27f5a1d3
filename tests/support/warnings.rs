//! What the library tells a host that reads its log.

use std::sync::{Arc, Mutex};

use feti_contact::solver::{LogLevel, Problem};

/// The results and warnings of the log from now on.
pub fn told(problem: &mut Problem) -> Arc<Mutex<String>> {
    let told = Arc::new(Mutex::new(String::new()));
    let lines = Arc::clone(&told);
    let listener = Box::new(move |_: LogLevel, line: &str| {
        lines.lock().unwrap().push_str(line);
        0
    });
    problem.on_log(Some((LogLevel::Result, listener)));
    told
}
