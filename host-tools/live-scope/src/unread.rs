//! Connections whose request is not read yet: whoever can connect may open them, so they have a place and a time
//! of their own.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read};
use std::net::{Shutdown, TcpStream};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Those that wait; where there are too many the oldest goes, so that nobody can keep the page's own requests out.
#[derive(Default)]
pub struct Unread(Mutex<Inner>);

#[derive(Default)]
struct Inner {
    /// Number of the next.
    next: u64,
    waiting: VecDeque<(u64, TcpStream)>,
}

/// A place among them, until it is dropped.
pub struct Place<'u> {
    unread: &'u Unread,
    number: u64,
}

impl Unread {
    /// Gives a connection a place among the `most` youngest.
    ///
    /// # Errors
    /// The operating system has no room for it.
    pub fn enter(&self, stream: &TcpStream, most: usize) -> io::Result<Place<'_>> {
        let stream = stream.try_clone()?;
        let mut inner = self.inner();
        let number = inner.next;
        inner.next += 1;
        inner.waiting.push_back((number, stream));
        if inner.waiting.len() > most
            && let Some((_, oldest)) = inner.waiting.pop_front()
        {
            // One that is gone already needs no end.
            let _ = oldest.shutdown(Shutdown::Both);
        }
        Ok(Place { unread: self, number })
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.unread.inner().waiting.retain(|(number, _)| *number != self.number);
    }
}

/// Reads a connection until a time, however its bytes come.
pub struct Until<'s> {
    /// The connection that is read.
    pub stream: &'s TcpStream,
    /// When it must have come.
    pub end: Instant,
}

impl Read for Until<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::net::TcpListener;
    use std::time::Duration;

    /// Both ends of a connection.
    fn connection() -> (TcpStream, TcpStream) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let theirs = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        (listener.accept().unwrap().0, theirs)
    }

    #[test]
    fn the_oldest_makes_room_and_who_has_left_does_not_count() {
        let unread = Unread::default();
        let [(first, mut sees), (second, _other), (third, _another)] = [connection(), connection(), connection()];
        let _place = unread.enter(&first, 2).unwrap();
        drop(unread.enter(&second, 2).unwrap());
        let _second = unread.enter(&second, 2).unwrap();
        sees.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
        assert!(sees.read(&mut [0]).is_err(), "it is open");
        let _third = unread.enter(&third, 2).unwrap();
        assert_eq!(sees.read(&mut [0]).unwrap(), 0, "it was ended");
    }

    #[test]
    fn a_drop_now_and_then_puts_the_end_off_no_longer() {
        let (ours, mut theirs) = connection();
        let drips = std::thread::spawn(move || {
            while theirs.write_all(b"G").is_ok() {
                std::thread::sleep(Duration::from_millis(20));
            }
        });
        let start = Instant::now();
        let mut until = Until { stream: &ours, end: start + Duration::from_millis(200) };
        let error = until.read_to_end(&mut Vec::new()).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock), "{error}");
        assert!(start.elapsed() >= Duration::from_millis(200));
        drop(ours);
        drips.join().unwrap();
    }
}
