//! The browser, as this test wants it: headless, alone, and cut off from any network but this machine.
//!
//! It is driven by the [DevTools protocol](https://chromedevtools.github.io/devtools-protocol/): JSON messages, each
//! ended by a NUL, that Chromium reads from file descriptor 3 and writes to 4 (`--remote-debugging-pipe`).

use std::{
    env,
    ffi::{OsStr, OsString},
    io::{BufRead, BufReader, Write},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    sync::mpsc::{self, Receiver, Sender},
    thread,
    time::Duration,
};

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use tempfile::TempDir;

/// No name leads anywhere; only what this machine serves itself is reached.
const OPTIONS: [&str; 12] = [
    "--headless=new",
    "--remote-debugging-pipe",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-dev-shm-usage",
    "--disable-extensions",
    "--disable-gpu",
    "--disable-sync",
    "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
];

/// How long the browser may take for an answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running browser; it ends with this value.
pub struct Browser {
    process: Child,
    commands: ChildStdin,
    messages: Receiver<Value>,
    /// Number of the latest command.
    latest: u64,
    /// Events that came while an answer was awaited, oldest first.
    events: Vec<Value>,
    _profile: TempDir,
}

/// Starts the browser that `$CHROME` names, or else `chromium`, with a fresh profile.
///
/// # Errors
/// No browser, or one that does not start.
pub fn launch() -> Result<Browser> {
    let program = env::var_os("CHROME").unwrap_or_else(|| OsString::from("chromium"));
    start(&program).with_context(|| {
        format!("{} does not start; run `cargo xtask setup` or set $CHROME to a Chromium or Chrome", program.display())
    })
}

fn start(program: &OsStr) -> Result<Browser> {
    let profile = TempDir::new()?;
    let mut profile_option = OsString::from("--user-data-dir=");
    profile_option.push(profile.path());
    // The shell gives Chromium its standard input and output as file descriptors 3 and 4.
    let mut command = Command::new("sh");
    command.args(["-c", r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1"#]).arg(program).args(OPTIONS);
    // Chromium's sandbox refuses to run as root, as tests in containers do.
    command.args(is_root().then_some("--no-sandbox")).arg(profile_option);
    let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let commands = process.stdin.take().context("its input is not piped")?;
    let answers = process.stdout.take().context("its output is not piped")?;
    let (sender, messages) = mpsc::channel();
    thread::spawn(move || read(answers, &sender));
    let mut browser = Browser { process, commands, messages, latest: 0, events: Vec::new(), _profile: profile };
    browser.call(None, "Browser.getVersion", &json!({}))?;
    Ok(browser)
}

impl Browser {
    /// Sends a command to a page's session, or to the browser itself, and returns its result.
    ///
    /// # Errors
    /// The browser refuses, has ended, or does not answer.
    pub(crate) fn call(&mut self, session: Option<&str>, method: &str, parameters: &Value) -> Result<Value> {
        self.latest += 1;
        let mut command = json!({ "id": self.latest, "method": method, "params": parameters });
        if let Some(session) = session {
            command["sessionId"] = session.into();
        }
        self.commands.write_all(format!("{command}\0").as_bytes()).context("the browser has ended")?;
        loop {
            let message = self.next().context(method.to_owned())?;
            if message["id"] == self.latest {
                if let Some(error) = message.get("error") {
                    bail!("{method}: {error}");
                }
                return Ok(message["result"].clone());
            }
            self.events.push(message);
        }
    }

    /// Waits until the session has reported an event that `is_awaited`. Events before and including it are kept.
    ///
    /// # Errors
    /// The browser has ended, or it does not come.
    pub(crate) fn wait(&mut self, session: &str, is_awaited: impl Fn(&Value) -> bool) -> Result<()> {
        let found = |event: &Value| event["sessionId"] == session && is_awaited(event);
        while !self.events.iter().any(found) {
            let message = self.next()?;
            self.events.push(message);
        }
        Ok(())
    }

    /// Takes what a session has reported so far, oldest first.
    pub(crate) fn take_events(&mut self, session: &str) -> Vec<Value> {
        let of_session = |event: &mut Value| event["sessionId"] == session;
        self.events.extract_if(.., of_session).collect()
    }

    fn next(&self) -> Result<Value> {
        self.messages.recv_timeout(PATIENCE).context("the browser has ended or fallen silent")
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Asked to close, it ends its helper processes too. Where it has ended already, there is nothing left to do.
        let _ = self.call(None, "Browser.close", &json!({}));
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Hands on every message until the browser or its [`Browser`] is gone.
fn read(answers: ChildStdout, messages: &Sender<Value>) {
    let whole = BufReader::new(answers).split(0).map_while(Result::ok);
    for message in whole.filter_map(|bytes| serde_json::from_slice(&bytes).ok()) {
        if messages.send(message).is_err() {
            break;
        }
    }
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout == b"0\n")
}
