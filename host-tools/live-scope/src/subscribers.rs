//! The pages that are open, and what each is to be sent.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

/// Messages that wait for one page; some ten seconds of them. A page that is farther behind is let go, and asks again.
const MOST_WAITING: usize = 256;

/// Those who are sent what happens.
#[derive(Default)]
pub struct Subscribers(Mutex<Inner>);

#[derive(Default)]
struct Inner {
    /// What a page must know that has just been opened, by the event's name.
    latest: Vec<(&'static str, Arc<str>)>,
    pages: Vec<SyncSender<Arc<str>>>,
}

impl Subscribers {
    /// What another page is sent from now on, what it must know first.
    pub fn subscribe(&self) -> Receiver<Arc<str>> {
        let (sender, receiver) = sync_channel(MOST_WAITING);
        let mut inner = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for (_, event) in &inner.latest {
            // It is empty as yet.
            let _ = sender.try_send(event.clone());
        }
        inner.pages.push(sender);
        receiver
    }

    /// Sends an event to all.
    pub fn send(&self, name: &'static str, json: &str) {
        let event = event(name, json);
        let mut inner = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        inner.pages.retain(|page| page.try_send(event.clone()).is_ok());
    }

    /// Sends an event to all that replaces the one before, and to who comes later.
    pub fn send_state(&self, name: &'static str, json: &str) {
        let mut inner = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        inner.latest.retain(|(other, _)| *other != name);
        inner.latest.push((name, event(name, json)));
        drop(inner);
        self.send(name, json);
    }

    /// Lets all go.
    pub fn close(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pages.clear();
    }
}

/// JSON has no line feed of its own.
fn event(name: &str, json: &str) -> Arc<str> {
    format!("event: {name}\ndata: {json}\n\n").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_comes_late_is_told_the_state_and_who_does_not_read_is_let_go() {
        let subscribers = Subscribers::default();
        subscribers.send_state("device", "1");
        subscribers.send_state("device", "2");
        subscribers.send("columns", "[]");
        let (reads, sleeps) = (subscribers.subscribe(), subscribers.subscribe());
        assert_eq!(&*reads.recv().unwrap(), "event: device\ndata: 2\n\n");
        for number in 0..300 {
            subscribers.send("columns", &number.to_string());
            assert_eq!(&*reads.recv().unwrap(), format!("event: columns\ndata: {number}\n\n"));
        }
        assert_eq!(sleeps.iter().count(), MOST_WAITING, "and then its end");
        subscribers.close();
        assert!(reads.recv().is_err());
    }
}
