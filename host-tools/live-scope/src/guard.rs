//! Who may ask: the page that this program served, under the name it was served by, and nobody else's page.
//!
//! A page of somebody else can have a browser send requests here, but neither read this page nor guess the secret part
//! of its address. What its own server's name is made to lead here (DNS rebinding) is told by the host that the browser
//! says: a number is nobody's name, and of names only `localhost` and the one that the user gave are ours.

use crate::http::Request;
use std::io;
use std::net::IpAddr;

/// Characters of the secret part of the address.
const SECRET: usize = 32;

/// Tells the page's own requests from those of other pages and hosts, by host, origin and a secret in the address.
#[derive(Clone, Debug)]
pub struct Guard {
    secret: String,
    port: u16,
    /// The name that the user gave.
    name: String,
}

/// Why a request is refused.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Refusal {
    /// It is for another host.
    Host,
    /// Another page sends it.
    Origin,
    /// It does not know the secret.
    Secret,
}

impl Guard {
    /// A guard with a new secret, for a name and a port.
    ///
    /// # Errors
    /// The operating system has no random numbers.
    pub fn new(name: &str, port: u16) -> io::Result<Self> {
        let mut random = [0; SECRET / 2];
        getrandom::fill(&mut random).map_err(io::Error::other)?;
        let secret = random.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { secret, port, name: name.to_owned() })
    }

    /// The path under which everything is.
    pub fn path(&self) -> String {
        format!("/{}/", self.secret)
    }

    /// What is asked for under that path.
    ///
    /// # Errors
    /// Somebody else asks.
    pub fn admit<'r>(&self, request: &'r Request) -> Result<&'r str, Refusal> {
        let host = request.host.as_deref().ok_or(Refusal::Host)?;
        if !self.is_ours(host) {
            return Err(Refusal::Host);
        }
        if request.origin.as_ref().is_some_and(|origin| *origin != format!("http://{host}")) {
            return Err(Refusal::Origin);
        }
        let path = request.path.strip_prefix('/').ok_or(Refusal::Secret)?;
        path.strip_prefix(&self.secret).and_then(|rest| rest.strip_prefix('/')).ok_or(Refusal::Secret)
    }

    fn is_ours(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.contains(']') => (name, port.parse().ok()),
            // A browser leaves the port of HTTP out.
            _ => (host, Some(80)),
        };
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        let ours = bare.parse::<IpAddr>().is_ok()
            || ["localhost", &self.name].iter().any(|ours| name.eq_ignore_ascii_case(ours));
        ours && port == Some(self.port)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(guard: &Guard, host: Option<&str>, origin: Option<&str>) -> Request {
        Request {
            method: "POST".to_owned(),
            path: format!("{}zero", guard.path()),
            host: host.map(str::to_owned),
            origin: origin.map(str::to_owned),
            body: Vec::new(),
        }
    }

    #[test]
    fn the_page_itself_is_admitted_under_its_names() {
        let guard = Guard::new("bench.example", 4750).unwrap();
        for host in ["127.0.0.1:4750", "localhost:4750", "[::1]:4750", "192.168.0.7:4750", "Bench.example:4750"] {
            let origin = format!("http://{host}");
            assert_eq!(guard.admit(&request(&guard, Some(host), Some(&origin))), Ok("zero"), "{host}");
            assert_eq!(guard.admit(&request(&guard, Some(host), None)), Ok("zero"), "{host}");
        }
        assert_eq!(Guard::new("127.0.0.1", 80).unwrap().path().len(), SECRET + 2);
    }

    #[test]
    fn other_hosts_pages_and_guesses_are_refused() {
        let guard = Guard::new("127.0.0.1", 4750).unwrap();
        let refused = |host, origin| guard.admit(&request(&guard, host, origin)).unwrap_err();
        for host in [
            None,
            Some("rebound.example:4750"),
            Some("127.0.0.1"),
            Some("127.0.0.1:4751"),
            Some("127.0.0.1.example:4750"),
            Some("localhost.example:4750"),
            Some(":4750"),
            Some(""),
        ] {
            assert_eq!(refused(host, None), Refusal::Host, "{host:?}");
        }
        for origin in ["null", "http://other.example", "http://127.0.0.1:8080", "https://127.0.0.1:4750", ""] {
            assert_eq!(refused(Some("127.0.0.1:4750"), Some(origin)), Refusal::Origin, "{origin}");
        }
        let other = Guard::new("127.0.0.1", 4750).unwrap();
        for path in
            ["/".to_owned(), "//zero".to_owned(), "zero".to_owned(), other.path(), guard.path()[..32].to_owned()]
        {
            let guess = Request { path, ..request(&guard, Some("127.0.0.1:4750"), None) };
            assert_eq!(guard.admit(&guess), Err(Refusal::Secret), "{}", guess.path);
        }
    }
}
