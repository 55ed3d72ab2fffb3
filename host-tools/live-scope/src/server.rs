//! The page's server: one file, the events that it draws, and what its buttons ask for.
//!
//! | path, behind the secret | |
//! |---|---|
//! | `GET /` | the page ([`crate::PAGE`]) |
//! | `GET /events` | what happens, as server-sent events, until the page is closed |
//! | `POST /zero`, `{"at_um": 12.5}` | the displacement of now is called that, µm |
//! | `POST /record`, `{"on": true}` | a recording begins, or ends |
//!
//! A request a connection, each in a thread of its own. Anything else, and whoever else asks, is refused
//! with a sentence.

use crate::error::Undone;
use crate::guard::{Guard, Refusal};
use crate::http::{self, Request, Status};
use crate::page::PAGE;
use crate::subscribers::Subscribers;
use crate::unread::{Unread, Until};
use serde::Deserialize;
use std::io::{self, BufReader, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Where the page is served where nothing else is said: to nobody but this machine, at a free port.
pub const HERE: &str = "127.0.0.1:0";
/// Most connections at once whose request has not come yet, and most requests of the page's readers that are answered.
const MOST: usize = 32;
/// How long a request may take to come, from first to last, or an answer to be taken.
const PATIENCE: Duration = Duration::from_secs(5);
/// How long a button waits for what it asked for.
const DONE: Duration = Duration::from_secs(5);
/// How often the end is looked for.
const LOOK: Duration = Duration::from_millis(20);
/// How often a page without news is sent something: how its end is noticed.
const ALIVE: Duration = Duration::from_secs(1);

/// The page cannot be served there.
#[derive(Debug, thiserror::Error)]
#[error(
    "{address}: no page can be served there: name an address of this machine and a port that is free, as 127.0.0.1:4750"
)]
pub struct ServerError {
    /// As it was given.
    pub address: String,
    /// What the operating system says.
    #[source]
    pub source: io::Error,
}

/// What a button asks for; both ends with a sentence, of what was done or why not.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Wish {
    /// Call the displacement of now so many µm.
    Zero(f64),
    /// Begin a recording, or end it.
    Record(bool),
}

/// A wish, and who waits for what becomes of it.
pub struct Asked {
    /// What the page asks the device for.
    pub wish: Wish,
    /// When it was wished.
    at: Instant,
    answer: SyncSender<Result<String, Undone>>,
}

impl Asked {
    /// Answers, in a sentence.
    pub fn answer(self, done: Result<String, Undone>) {
        // Who has gone does not wait.
        let _ = self.answer.send(done);
    }
}

/// What the threads share.
struct Shared {
    guard: Guard,
    subscribers: Subscribers,
    asked: SyncSender<Asked>,
    unread: Unread,
    /// Requests that are being answered to who knows the secret.
    admitted: AtomicUsize,
    over: AtomicBool,
}

/// A server; dropped, it ends.
pub struct Server {
    url: String,
    loopback: bool,
    asked: Receiver<Asked>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Serves at a `HOST:PORT`, or a `HOST` at a free port.
    ///
    /// # Errors
    /// It is no address of this machine, or the port is taken.
    pub fn start(address: &str) -> Result<Self, ServerError> {
        let failed = |source| ServerError { address: address.to_owned(), source };
        let listener = listen(address).map_err(failed)?;
        let local = listener.local_addr().map_err(failed)?;
        let host =
            address.rsplit_once(':').filter(|(_, port)| port.parse::<u16>().is_ok()).map_or(address, |(host, _)| host);
        let guard = Guard::new(host, local.port()).map_err(failed)?;
        let url = format!("http://{}{}", reached(local), guard.path());
        let (sender, asked) = sync_channel(1);
        let shared = Arc::new(Shared {
            guard,
            subscribers: Subscribers::default(),
            asked: sender,
            unread: Unread::default(),
            admitted: AtomicUsize::new(0),
            over: AtomicBool::new(false),
        });
        let thread = {
            let shared = shared.clone();
            std::thread::Builder::new()
                .name("page".to_owned())
                .spawn(move || accept(&listener, &shared))
                .map_err(failed)?
        };
        Ok(Self { url, loopback: local.ip().is_loopback(), asked, shared, thread: Some(thread) })
    }

    /// The page's address, with the secret that admits its reader.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Whether nobody but this machine can reach it.
    pub fn is_loopback(&self) -> bool {
        self.loopback
    }

    /// What a page has asked for, if one has and still waits for it.
    pub fn asked(&self) -> Option<Asked> {
        self.asked.try_iter().find(|asked| asked.at.elapsed() < DONE)
    }

    /// Who is sent what happens.
    pub(crate) fn subscribers(&self) -> &Subscribers {
        &self.shared.subscribers
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.over.store(true, Ordering::Relaxed);
        self.shared.subscribers.close();
        // A panic there has been printed.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn listen(address: &str) -> io::Result<TcpListener> {
    let with_port = address.to_socket_addrs().map(Vec::from_iter);
    let addresses: Vec<SocketAddr> = with_port.or_else(|_| (address, 0).to_socket_addrs().map(Vec::from_iter))?;
    let listener = TcpListener::bind(&addresses[..])?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Where a browser on this machine finds it.
fn reached(local: SocketAddr) -> SocketAddr {
    let ip = match local {
        SocketAddr::V4(at) if at.ip().is_unspecified() => std::net::Ipv4Addr::LOCALHOST.into(),
        SocketAddr::V6(at) if at.ip().is_unspecified() => std::net::Ipv6Addr::LOCALHOST.into(),
        at => at.ip(),
    };
    SocketAddr::new(ip, local.port())
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    while !shared.over.load(Ordering::Relaxed) {
        match listener.accept() {
            Ok((stream, _)) => {
                let shared = shared.clone();
                let serve = move || {
                    // A browser that goes away while it is answered has no need of the rest.
                    let _ = serve(stream, &shared);
                };
                // Where there can be no more threads, the connection ends here.
                let _ = std::thread::Builder::new().name("page's request".to_owned()).spawn(serve);
            }
            Err(_) => std::thread::sleep(LOOK),
        }
    }
}

/// One of those that are answered, until it is dropped.
struct Admitted<'s>(&'s AtomicUsize);

impl<'s> Admitted<'s> {
    /// `None` where there are too many.
    fn to(count: &'s AtomicUsize) -> Option<Self> {
        let before = count.fetch_add(1, Ordering::Relaxed);
        // Dropped, it counts itself no more.
        Some(Self(count)).filter(|_| before < MOST)
    }
}

impl Drop for Admitted<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

fn serve(mut stream: TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let place = shared.unread.enter(&stream, MOST)?;
    let read = http::read(&mut BufReader::new(Until { stream: &stream, end: Instant::now() + PATIENCE }))?;
    drop(place);
    let Some(request) = read else {
        return say(&mut stream, Status::Bad, "this is no request of the page");
    };
    match shared.guard.admit(&request) {
        Err(Refusal::Host) => say(&mut stream, Status::Forbidden, "the page is not to be had under this name"),
        Err(Refusal::Origin) => say(&mut stream, Status::Forbidden, "another page asks: only the scope's own may"),
        Err(Refusal::Secret) => say(
            &mut stream,
            Status::NotFound,
            "nothing is here: open the whole address that was printed where the page is served",
        ),
        Ok(path) => {
            let Some(_admitted) = Admitted::to(&shared.admitted) else {
                return say(&mut stream, Status::Busy, "too many connections: close some of the pages");
            };
            answer(path, &request, stream, shared)
        }
    }
}

fn answer(path: &str, request: &Request, mut stream: TcpStream, shared: &Shared) -> io::Result<()> {
    match (request.method.as_str(), path) {
        ("GET", "") => http::answer(&mut stream, Status::Ok, "text/html", &PAGE),
        ("GET", "events") => events(stream, shared),
        ("POST", wish) => {
            let (status, said) = match ask(wish, request, shared) {
                Ok(Ok(said)) => (Status::Ok, said),
                Ok(Err(why)) => (Status::Conflict, why.told()),
                Err(status) => (status, "this is nothing that the page asks for".to_owned()),
            };
            say(&mut stream, status, &said)
        }
        _ => say(&mut stream, Status::NotFound, "nothing is here"),
    }
}

fn say(stream: &mut TcpStream, status: Status, sentence: &str) -> io::Result<()> {
    http::answer(stream, status, "text/plain", sentence)
}

/// Sends what happens until the page is closed, or falls behind, or the server ends.
fn events(mut stream: TcpStream, shared: &Shared) -> io::Result<()> {
    let events = shared.subscribers.subscribe();
    http::begin_events(&mut stream)?;
    loop {
        match events.recv_timeout(ALIVE) {
            Ok(event) => stream.write_all(event.as_bytes())?,
            // A comment, which the page does not see.
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => stream.write_all(b":\n\n")?,
            Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if shared.over.load(Ordering::Relaxed) {
            return Ok(());
        }
    }
}

/// Hands a wish on, and waits for what becomes of it.
fn ask(path: &str, request: &Request, shared: &Shared) -> Result<Result<String, Undone>, Status> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Zero {
        at_um: f64,
    }
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Record {
        on: bool,
    }
    let wish = match path {
        "zero" => serde_json::from_slice(&request.body).map(|Zero { at_um }| Wish::Zero(at_um)),
        "record" => serde_json::from_slice(&request.body).map(|Record { on }| Wish::Record(on)),
        _ => return Err(Status::NotFound),
    };
    let wish = wish.map_err(|_| Status::Bad)?;
    let (answer, done) = sync_channel(1);
    if shared.asked.try_send(Asked { wish, at: Instant::now(), answer }).is_err() {
        return Ok(Err(Undone::Busy));
    }
    Ok(done.recv_timeout(DONE).unwrap_or(Err(Undone::Unknown)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wish_that_nobody_waits_for_any_more_is_forgotten() {
        let server = Server::start(HERE).unwrap();
        let wish = |at| {
            let (answer, done) = sync_channel(1);
            server.shared.asked.try_send(Asked { wish: Wish::Zero(7.0), at, answer }).map_err(|_| "full").unwrap();
            done
        };
        let now = Instant::now();
        let done = wish(now.checked_sub(DONE).unwrap());
        assert!(server.asked().is_none() && done.recv().is_err());
        let _waits = wish(now);
        assert!(server.asked().is_some_and(|asked| asked.wish == Wish::Zero(7.0)));
    }
}
