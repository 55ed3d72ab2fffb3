//! What people see while a verb runs, line by line.

/// A progress bar on a terminal, nothing in a pipe.
pub fn progress(length: u64) -> indicatif::ProgressBar {
    let style = indicatif::ProgressStyle::with_template("{prefix:28} {wide_bar} {percent:>3} %  {msg}  {eta} left")
        .unwrap_or_else(|_| indicatif::ProgressStyle::default_bar());
    indicatif::ProgressBar::new(length).with_style(style)
}

/// Prints a line to standard output. A reader who has closed the pipe has seen enough; anything else that keeps the
/// line from being written (a full disk) ends the program with exit code 2.
pub fn out(line: &str) {
    still_read(line);
}

/// The same of a line that others are to follow; whether somebody still reads them.
pub fn still_read(line: &str) -> bool {
    crate::output::standard(format!("{line}\n").as_bytes()).unwrap_or_else(|error| {
        eprintln!("piezo: {error:#}");
        std::process::exit(2)
    })
}
