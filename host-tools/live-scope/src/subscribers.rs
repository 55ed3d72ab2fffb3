//! The pages that are open, and what each is to be sent.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Messages that wait for one page; some ten seconds of them. A page that is farther behind is let go, and asks again.
const MOST_WAITING: usize = 256;
/// Messages that a page is sent which was opened later: at twenty a second the minute that it shows.
const MOST_KEPT: usize = 1200;

/// Those who are sent what happens.
#[derive(Default)]
pub struct Subscribers(Mutex<Inner>);

#[derive(Default)]
struct Inner {
    /// What a page must know that has just been opened, by the event's name.
    latest: Vec<(&'static str, Arc<str>)>,
    /// What has been sent to all since [`Subscribers::begin`].
    kept: VecDeque<Arc<str>>,
    pages: Vec<SyncSender<Arc<str>>>,
}

impl Subscribers {
    /// What another page is sent from now on, what it must know first.
    pub fn subscribe(&self) -> Receiver<Arc<str>> {
        let (sender, receiver) = sync_channel(MOST_WAITING);
        let mut inner = self.inner();
        let first: String =
            inner.latest.iter().map(|(_, event)| &**event).chain(inner.kept.iter().map(|event| &**event)).collect();
        // It is empty as yet.
        let _ = sender.try_send(first.into());
        inner.pages.push(sender);
        receiver
    }

    /// Sends an event to all; who comes within a minute is sent it, too.
    pub fn send(&self, name: &'static str, json: &str) {
        let mut inner = self.inner();
        let event = inner.send(name, json);
        inner.kept.push_back(event);
        if inner.kept.len() > MOST_KEPT {
            inner.kept.pop_front();
        }
    }

    /// Sends an event to all that replaces the one before; whoever comes later is sent the last.
    pub fn send_state(&self, name: &'static str, json: &str) {
        self.inner().send_state(name, json);
    }

    /// The same of an event behind which nothing counts that was sent before.
    pub fn begin(&self, name: &'static str, json: &str) {
        let mut inner = self.inner();
        inner.kept.clear();
        inner.send_state(name, json);
    }

    /// Ends the connections of all pages.
    pub fn close(&self) {
        self.inner().pages.clear();
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    fn send(&mut self, name: &str, json: &str) -> Arc<str> {
        let event = event(name, json);
        self.pages.retain(|page| page.try_send(event.clone()).is_ok());
        event
    }

    fn send_state(&mut self, name: &'static str, json: &str) {
        let event = self.send(name, json);
        self.latest.retain(|(other, _)| *other != name);
        self.latest.push((name, event));
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

    #[test]
    fn who_comes_late_is_sent_the_last_minute_of_this_device() {
        let subscribers = Subscribers::default();
        subscribers.send("columns", "of another");
        subscribers.begin("device", "1");
        subscribers.send_state("state", "2");
        (0..MOST_KEPT + 3).for_each(|number| subscribers.send("columns", &number.to_string()));
        let first = subscribers.subscribe().recv().unwrap();
        let events: Vec<&str> = first.split_terminator("\n\n").collect();
        assert_eq!(events[..3], ["event: device\ndata: 1", "event: state\ndata: 2", "event: columns\ndata: 3"]);
        assert_eq!(events.len(), 2 + MOST_KEPT);
    }
}
