//! As much of HTTP/1.1 (RFC 9112) as one page needs: a request a connection, small, and an answer.

use std::io::{self, BufRead, Read, Write};

/// Longest head of a request, bytes, and most lines of it.
const MOST_HEAD: usize = 8192;
const MOST_HEADERS: usize = 64;
/// Longest body, bytes.
const MOST_BODY: usize = 1024;
/// With every answer: nothing is kept, guessed, framed, told to other pages, or loaded from anywhere else.
const ALWAYS: &str = "Cache-Control: no-store\r\n\
     X-Content-Type-Options: nosniff\r\n\
     X-Frame-Options: DENY\r\n\
     Referrer-Policy: no-referrer\r\n\
     Cross-Origin-Resource-Policy: same-origin\r\n\
     Content-Security-Policy: default-src 'none'; connect-src 'self'; img-src data:; script-src 'unsafe-inline'; \
     style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\
     Connection: close\r\n";

/// What is asked for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Request {
    /// `GET` or `POST`.
    pub method: String,
    /// From the first `/` on.
    pub path: String,
    /// Of the header, where there is one.
    pub host: Option<String>,
    /// Of the header, where there is one: the page that asks.
    pub origin: Option<String>,
    /// What comes with it.
    pub body: Vec<u8>,
}

/// What is answered, other than what was asked for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// It is no request.
    Bad,
    /// 403: the request is not the page's own.
    Forbidden,
    /// 404: there is nothing at this path.
    NotFound,
    /// It cannot be done now.
    Conflict,
    /// 503: as many connections are open as are served.
    Busy,
    /// What was asked for was done, or follows.
    Ok,
}

impl Status {
    const fn line(self) -> &'static str {
        match self {
            Self::Bad => "400 Bad Request",
            Self::Forbidden => "403 Forbidden",
            Self::NotFound => "404 Not Found",
            Self::Conflict => "409 Conflict",
            Self::Busy => "503 Service Unavailable",
            Self::Ok => "200 OK",
        }
    }
}

/// Reads a request; `None` where what comes is none, or too long.
///
/// # Errors
/// The connection's.
pub fn read(from: &mut impl BufRead) -> io::Result<Option<Request>> {
    let mut head = Vec::new();
    let mut limited = from.take(MOST_HEAD as u64);
    while !head.ends_with(b"\r\n\r\n") {
        if limited.read_until(b'\n', &mut head)? == 0 {
            return Ok(None);
        }
    }
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    let whole = parsed.parse(&head).is_ok_and(|status| status.is_complete());
    let (true, Some(method), Some(path)) = (whole, parsed.method, parsed.path) else { return Ok(None) };
    let count = |name: &str| parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name)).count();
    // What is said twice, or in another encoding than a length, is said to deceive.
    if ["host", "origin", "content-length"].iter().any(|name| count(name) > 1) || count("transfer-encoding") > 0 {
        return Ok(None);
    }
    let value = |name: &str| {
        let header = parsed.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name))?;
        Some(String::from_utf8_lossy(header.value).into_owned())
    };
    let length = match value("content-length").map(|length| length.parse()) {
        None => 0,
        Some(Ok(length)) if length <= MOST_BODY => length,
        Some(_) => return Ok(None),
    };
    let request = Request {
        method: method.to_owned(),
        path: path.to_owned(),
        host: value("host"),
        origin: value("origin"),
        body: Vec::new(),
    };
    let mut body = vec![0; length];
    from.read_exact(&mut body)?;
    Ok(Some(Request { body, ..request }))
}

/// Writes a whole answer.
///
/// # Errors
/// The connection's, here and below.
pub fn answer(to: &mut impl Write, status: Status, kind: &str, body: &str) -> io::Result<()> {
    write!(
        to,
        "HTTP/1.1 {}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\n{ALWAYS}\r\n{body}",
        status.line(),
        body.len()
    )?;
    to.flush()
}

/// Begins an answer that goes on: events, as the browser's `EventSource` reads them.
pub fn begin_events(to: &mut impl Write) -> io::Result<()> {
    write!(to, "HTTP/1.1 {}\r\nContent-Type: text/event-stream; charset=utf-8\r\n{ALWAYS}\r\n", Status::Ok.line())?;
    to.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<Request> {
        read(&mut text.as_bytes()).unwrap()
    }

    #[test]
    fn a_request_is_read_with_its_body() {
        let request =
            of("POST /t/zero HTTP/1.1\r\nHOST: localhost:1\r\norigin: http://a\r\nContent-Length: 2\r\n\r\n{}x")
                .unwrap();
        assert_eq!((request.method.as_str(), request.path.as_str()), ("POST", "/t/zero"));
        assert_eq!((request.host.as_deref(), request.origin.as_deref()), (Some("localhost:1"), Some("http://a")));
        assert_eq!(request.body, b"{}");
    }

    #[test]
    fn what_is_no_request_is_none() {
        let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(MOST_HEAD));
        let much = format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(MOST_HEADERS + 1));
        for text in [
            "",
            "GET / HTTP/1.1\r\n",
            "\r\n\r\n",
            "\u{16}\u{3}\u{1}\r\n\r\n",
            &long,
            &much,
            "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n",
            "POST / HTTP/1.1\r\nContent-Length: 1025\r\n\r\n",
            "POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
            "POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        ] {
            assert_eq!(of(text), None, "{text:.60?}");
        }
        assert!(read(&mut "POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\n{}".as_bytes()).is_err());
    }
}
