//! A browser that has the page.

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(20);

/// Where the page is.
pub struct Page {
    pub host: String,
    pub path: String,
}

impl Page {
    pub fn of(url: &str) -> Self {
        let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
        Self { host: host.to_owned(), path: format!("/{path}") }
    }

    /// Sends a request with these lines in its head; what is answered.
    pub fn send(&self, request: &str, head: &str, body: &str) -> BufReader<TcpStream> {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        write!(stream, "{request} HTTP/1.1\r\n{head}Content-Length: {}\r\n\r\n{body}", body.len()).unwrap();
        BufReader::new(stream)
    }

    pub fn asked(&self, request: &str, head: &str, body: &str) -> (String, String) {
        let mut answer = String::new();
        self.send(request, head, body).read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().to_owned(), body.to_owned())
    }

    /// As the page's own script asks.
    pub fn asks(&self, what: &str, body: &str) -> (String, String) {
        let head = format!("Host: {0}\r\nOrigin: http://{0}\r\n", self.host);
        self.asked(&format!("POST {}{what}", self.path), &head, body)
    }

    pub fn events(&self) -> Events {
        let head = format!("Host: {}\r\n", self.host);
        let mut answer = self.send(&format!("GET {}events", self.path), &head, "");
        let mut line = String::new();
        while line != "\r\n" {
            line.clear();
            assert_ne!(answer.read_line(&mut line).unwrap(), 0);
        }
        Events(answer)
    }
}

/// What the page is sent.
pub struct Events(BufReader<TcpStream>);

impl Events {
    pub fn next(&mut self) -> (String, Value) {
        let mut name = String::new();
        loop {
            let mut line = String::new();
            assert_ne!(self.0.read_line(&mut line).unwrap(), 0, "the events end");
            if let Some(event) = line.strip_prefix("event: ") {
                event.trim().clone_into(&mut name);
            }
            if let Some(data) = line.strip_prefix("data: ") {
                return (name, serde_json::from_str(data).unwrap());
            }
        }
    }

    /// The next of a name that is as it should be.
    pub fn wait(&mut self, name: &str, is: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        let mut last = Value::Null;
        while start.elapsed() < PATIENCE {
            let (event, data) = self.next();
            if event == name {
                if is(&data) {
                    return data;
                }
                last = data;
            }
        }
        panic!("no such {name}; the last was {last}");
    }
}
