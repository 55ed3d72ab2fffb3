//! The client against a device that loses, damages and refuses.

use super::fake::{Fake, Manners};
use super::{Client, LinkError};
use crate::Anyway;
use protocol::{Mode, Record, Refusal, Request, TableSource};

/// Requests that connecting takes: the stream is stopped, and the device identified.
const CONNECTING: u32 = 2;

fn record(fake: &Fake) -> Record {
    crate::table::to_record(&fake.table())
}

#[test]
fn lost_and_damaged_replies_are_asked_for_again() {
    let fake = Fake::start(Manners {
        lose_replies: vec![0, CONNECTING + 1],
        damage_replies: vec![CONNECTING + 3, CONNECTING + 4],
        ..Manners::default()
    });
    let (mut client, identity) = fake.connect();
    assert_eq!(identity.board, "fake");
    client.health().unwrap();
    assert_eq!(client.pull().unwrap(), record(&fake));
    client.health().unwrap();
    assert_eq!(client.damaged(), 2);
}

#[test]
fn three_lost_replies_are_silence_and_the_next_request_is_answered() {
    let lose = (CONNECTING..CONNECTING + 3).collect();
    let fake = Fake::start(Manners { lose_replies: lose, ..Manners::default() });
    let (mut client, _) = fake.connect();
    assert!(matches!(client.health(), Err(LinkError::Silent { .. })));
    client.health().unwrap();
}

#[test]
fn what_does_more_the_second_time_is_asked_once() {
    let fake = Fake::start(Manners { lose_replies: vec![CONNECTING], ..Manners::default() });
    let (mut client, _) = fake.connect();
    assert!(matches!(client.set_zero(), Err(LinkError::Unknown { .. })));
}

#[test]
fn a_device_that_streams_already_does_not_confuse() {
    let fake = Fake::start(Manners { streams: true, ..Manners::default() });
    let (mut client, _) = fake.connect();
    assert_eq!(client.damaged(), 0, "what was cut by opening the port was not damaged under way");
    assert_eq!(client.samples(std::time::Duration::from_millis(100)).unwrap(), None, "the stream was stopped");
}

#[test]
fn samples_that_come_between_request_and_reply_are_kept() {
    let fake = Fake::start(Manners::default());
    let (mut client, _) = fake.connect();
    client.stream(true).unwrap();
    let mut next = None;
    for _ in 0..20 {
        client.health().unwrap();
        while let Some(samples) = client.samples(std::time::Duration::ZERO).unwrap() {
            assert!(next.is_none_or(|next| next == samples.first), "{next:?} {}", samples.first);
            next = Some(samples.first + samples.samples.len() as u32);
        }
    }
    assert!(next.is_some());
}

#[test]
fn another_version_is_named_and_which_side_is_older() {
    let fake = Fake::start(Manners { newer: true, ..Manners::default() });
    let error = Client::connect(fake.address()).err().unwrap().to_string();
    assert!(error.contains("version 2") && error.contains("this program is older"), "{error}");
}

#[test]
fn refusals_say_why() {
    let fake = Fake::start(Manners::default());
    let (mut client, _) = fake.connect();
    let refusal = |error: LinkError| match error {
        LinkError::Refused { refusal, .. } => *refusal,
        other => panic!("{other}"),
    };
    assert_eq!(refusal(client.push(record(&fake), Anyway::default()).unwrap_err()), Refusal::Estimating);
    let corrupt = Record::from_slice(&[0; 100]).unwrap();
    assert!(matches!(
        refusal(client.push(corrupt, Anyway { while_estimating: true, rewired: false }).unwrap_err()),
        Refusal::Table(_)
    ));
    assert_eq!(refusal(client.request(Request::Feed(Default::default())).unwrap_err()), Refusal::NotPil);
}

#[test]
fn a_pushed_table_is_in_use_after_the_restart() {
    let fake = Fake::start(Manners::default());
    let (mut client, identity) = fake.connect();
    assert!(matches!(identity.source, TableSource::Compiled { .. }));
    client.set_mode(Mode::Pause).unwrap();
    client.push(record(&fake), Anyway::default()).unwrap();
    assert_eq!(client.restart().unwrap().source, TableSource::Stored);
    assert_eq!(client.health().unwrap().mode, Mode::Estimate);
}
