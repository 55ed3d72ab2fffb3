//! The page as a browser has it, over HTTP, beside an emulated device.

mod browser;

use browser::Page;
use device_link::{Client, words};
use emulator::faults::samples;
use emulator::{Emulator, FaultyLine, TABLE};
use estimator_core::{AdcCode, DacCode, Status};
use live_scope::{Device, Gone, PAGE, Scope, Server, run, server};
use protocol::Mode;
use recordings::log::{ReadOptions, read};
use serde_json::Value;
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

fn open(address: SocketAddr) -> Result<Device, Gone> {
    let (client, identity) = Client::connect(&address.into()).map_err(|error| Gone(error.to_string()))?;
    Ok(Device { client, identity, table: TABLE.admit().expect("the image's table is admitted"), sensor: None })
}

/// Shows the device at an address while `then` looks at the page.
fn shown(device: SocketAddr, folder: &Path, then: impl FnOnce(&Page)) {
    let server = Server::start(server::HERE).unwrap();
    assert!(server.is_loopback());
    let page = Page::of(server.url());
    let over = AtomicBool::new(false);
    // A failed assertion ends what it is about, too.
    struct End<'a>(&'a AtomicBool);
    impl Drop for End<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    std::thread::scope(|threads| {
        let over = &over;
        threads.spawn(move || {
            let first = open(device).unwrap();
            let mut scope = Scope::new(&server, folder, None);
            run(first, &mut scope, &mut || open(device), &|| over.load(Ordering::Relaxed))
        });
        let _end = End(over);
        then(&page);
    });
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn who_opens_the_page_is_shown_the_device_in_figures_and_words() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().start().unwrap();
    shown(device.address(), folder.path(), |page| {
        let (status, body) = page.asked(&format!("GET {}", page.path), &format!("Host: {}\r\n", page.host), "");
        assert!(status == "200" && body == *PAGE);
        let mut events = page.events();
        let device = events.wait("device", |_| true);
        assert!(device["board"].as_str().unwrap().starts_with("emulated, firmware"), "{device}");
        assert_eq!((&device["column_s"], &device["sensor"]), (&0.005.into(), &false.into()));
        let turned = words::status(Status::NOT_SETTLED).next().unwrap().1;
        let state = events.wait("state", |state| state["words"].to_string().contains(turned));
        assert!(state["gone"].is_null() && state["mode"] == "estimates from its ADC", "{state}");
        let state = events.wait("state", |state| number(&state["rate"]) > 200.0);
        assert!(number(&state["displacement_um"][1]) <= number(&state["displacement_um"][2]), "{state}");
        let mut followed = 0;
        while followed < 10 {
            let columns = events.wait("columns", |_| true);
            let (columns, points) = (columns["columns"].as_array().unwrap(), columns["points"].as_array().unwrap());
            assert_eq!(columns.len(), points.len());
            for pair in columns.windows(2) {
                assert!(number(&pair[0][2][0]) <= number(&pair[0][2][1]) && pair[0][5].is_null(), "{pair:?}");
                // A machine that is too busy loses samples: then a column says so, and begins anywhere.
                if pair.iter().all(|column| column[1] == 0) {
                    assert!((number(&pair[1][0]) - number(&pair[0][0]) - 0.005).abs() < 1e-9, "{pair:?}");
                    followed += 1;
                }
            }
        }
    });
}

#[test]
fn a_glitch_of_one_tick_reaches_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut tick = 0;
    let glitches = move |_: DacCode| {
        tick = (tick + 1) % 997;
        AdcCode(if tick == 0 { 60_000 } else { 20_000 + 10 * tick }).into()
    };
    let device = Emulator::new().plant(glitches).start().unwrap();
    let glitch = f64::from(TABLE.adc.voltage::<f32>(AdcCode(60_000)));
    let is_glitch = |column: &Value| (number(&column[2][1]) - glitch).abs() < 1e-3;
    shown(device.address(), folder.path(), |page| {
        let mut events = page.events();
        let with = |message: &Value| message["columns"].as_array().unwrap().iter().any(is_glitch);
        let message = events.wait("columns", with);
        let at = message["columns"].as_array().unwrap().iter().position(is_glitch).unwrap();
        let volts: Vec<f64> = message["points"][at].as_array().unwrap().iter().step_by(2).map(number).collect();
        assert!(volts.iter().any(|volt| (volt - glitch).abs() < 1e-3), "the loop has it, too: {volts:?}");
    });
}

#[test]
fn its_button_zeroes_and_says_what_came_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().start().unwrap();
    shown(device.address(), folder.path(), |page| {
        let mut events = page.events();
        events.wait("state", |state| state["bias"].as_str().is_some_and(|bias| bias.contains("never zeroed")));
        let (status, said) = page.asks("zero", r#"{"at_um": 7.5}"#);
        assert!(status == "200" && said.starts_with("called 7.5 µm; zeroed 0 s ago, bias "), "{said}");
        // However soon after the one before.
        for _ in 0..5 {
            let (status, said) = page.asks("zero", r#"{"at_um": 7.5}"#);
            assert!(status == "200", "{said}");
        }
        events.wait("state", |state| state["bias"].as_str().is_some_and(|bias| bias.starts_with("zeroed ")));
        let (status, said) = page.asks("zero", r#"{"at_um": 1e5}"#);
        assert!(status == "409" && said.contains("the device refuses"), "{said}");
        for nonsense in ["", "{}", "7", r#"{"at_um": 1e999}"#, r#"{"at_um": "7"}"#, r#"{"at_um": 7, "and": 8}"#] {
            assert_eq!(page.asks("zero", nonsense).0, "400", "{nonsense}");
        }
    });
}

#[test]
fn its_button_says_what_a_zero_is_worth_that_is_told_while_the_voltage_moves() {
    let folder = tempfile::tempdir().unwrap();
    let says = |device: SocketAddr| {
        let mut said = String::new();
        shown(device, folder.path(), |page| {
            page.events().wait("state", |state| state["rate"].as_f64().is_some_and(|rate| rate > 0.0));
            said = page.asks("zero", r#"{"at_um": 7.5}"#).1;
        });
        said
    };
    // The emulated converter goes up and down once a second.
    let moving = Emulator::new().start().unwrap();
    let said = says(moving.address());
    assert!(
        said.starts_with("called 7.5 µm; zeroed ") && said.contains("; careful: the voltage is moving, by "),
        "{said}"
    );
    let mut noise = 0;
    let still = move |_| {
        noise = 1 - noise;
        AdcCode(30_000 + noise).into()
    };
    let still = Emulator::new().plant(still).start().unwrap();
    let said = says(still.address());
    assert!(said.starts_with("called 7.5 µm; zeroed ") && !said.contains("moving"), "{said}");
}

#[test]
fn its_button_zeroes_only_where_the_verb_does() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    client.set_mode(Mode::Pause).unwrap();
    drop(client);
    shown(device.address(), folder.path(), |page| {
        let (status, said) = page.asks("zero", r#"{"at_um": 7.5}"#);
        assert!(status == "409" && said.contains("make it estimate again: piezo reset --port tcp:"), "{said}");
    });
}

#[test]
fn nobody_else_may_ask() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().start().unwrap();
    shown(device.address(), folder.path(), |page| {
        let zero = format!("POST {}zero", page.path);
        let (ours, body) = (format!("Host: {}\r\n", page.host), r#"{"at_um": 7}"#);
        let port = page.host.rsplit_once(':').unwrap().1;
        let others = [
            ("403", zero.clone(), format!("{ours}Origin: http://other.example\r\n")),
            ("403", zero.clone(), format!("{ours}Origin: null\r\n")),
            ("403", zero.clone(), format!("Host: rebound.example:{port}\r\nOrigin: http://rebound.example:{port}\r\n")),
            ("403", zero.clone(), String::new()),
            ("404", "POST /zero".to_owned(), ours.clone()),
            ("404", format!("POST /{}/zero", "0".repeat(32)), ours.clone()),
            ("404", "GET /".to_owned(), ours.clone()),
            ("404", format!("GET {}zero", page.path), ours.clone()),
            ("404", format!("POST {}other", page.path), ours.clone()),
            ("400", format!("POST {}zero HTTP/1.1\r\nHost: twice", page.path), ours.clone()),
        ];
        for (status, request, head) in others {
            let (found, said) = page.asked(&request, &head, body);
            assert_eq!(found, status, "{request} {head}: {said}");
        }
        let mut events = page.events();
        let state = events.wait("state", |_| true);
        assert!(state["bias"].as_str().unwrap().contains("never zeroed"), "{state}");
    });
}

#[test]
fn what_it_records_are_logs_beside_one_another() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().start().unwrap();
    shown(device.address(), folder.path(), |page| {
        let mut events = page.events();
        for name in ["recording-1.csv", "recording-2.csv"] {
            let (status, said) = page.asks("record", r#"{"on": true}"#);
            assert!(status == "200" && said.contains(name), "{said}");
            assert_eq!(page.asks("record", r#"{"on": true}"#).0, "409");
            let long = |state: &Value| state["recording"]["seconds"].as_f64().is_some_and(|seconds| seconds > 0.3);
            let state = events.wait("state", long);
            assert!(state["recording"]["file"].as_str().unwrap().ends_with(name), "{state}");
            let (status, said) = page.asks("record", r#"{"on": false}"#);
            assert!(status == "200" && said.contains(&format!("{name} holds ")), "{said}");
            let log = read(&folder.path().join(name), &ReadOptions::default()).unwrap();
            assert!(log.voltage.len() > 600 && log.sample_period == 0.0005 && log.displacement_estimated);
        }
        assert_eq!(page.asks("record", r#"{"on": false}"#).0, "200");
    });
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn lost_samples_are_said_and_end_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().start().unwrap();
    // A batch is lost once something is recorded, however long that takes.
    let loses = Arc::new(AtomicBool::new(false));
    let fault = {
        let loses = loses.clone();
        samples(move |_| !loses.swap(false, Ordering::Relaxed))
    };
    let line = FaultyLine::to(device.address(), fault).unwrap();
    shown(line.address(), folder.path(), |page| {
        let mut events = page.events();
        assert_eq!(page.asks("record", r#"{"on": true}"#).0, "200");
        events.wait("state", |state| state["recording"]["seconds"].as_f64().is_some_and(|seconds| seconds > 0.1));
        loses.store(true, Ordering::Relaxed);
        let gap = |message: &Value| message["columns"].as_array().unwrap().iter().any(|column| column[1] == 1);
        events.wait("columns", gap);
        let state = events.wait("state", |state| state["lost"] != 0 && state["recorded"].is_string());
        let recorded = state["recorded"].as_str().unwrap();
        assert!(recorded.contains("samples were lost") && recorded.contains("recording-1.csv holds "), "{state}");
        read(&folder.path().join("recording-1.csv"), &ReadOptions::default()).unwrap();
    });
}

#[test]
fn a_device_that_dies_is_said_and_looked_for() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().start().unwrap();
    let address = device.address();
    let log = folder.path().join("recording-1.csv");
    shown(address, folder.path(), move |page| {
        let mut events = page.events();
        assert_eq!(page.asks("record", r#"{"on": true}"#).0, "200");
        events.wait("state", |state| state["recording"]["seconds"].as_f64().is_some_and(|seconds| seconds > 0.1));
        // A page that is closed ends nothing either.
        drop(page.events());
        device.shutdown();
        let state = events.wait("state", |state| state["gone"].is_string());
        let gone = state["gone"].as_str().unwrap();
        assert!(
            gone.contains(&address.to_string()) && state["recorded"].to_string().contains("link failed"),
            "{state}"
        );
        read(&log, &ReadOptions::default()).unwrap();
        let (status, said) = page.asks("zero", r#"{"at_um": 7}"#);
        assert!(status == "409" && said.contains(&address.to_string()), "{said}");
        let _again = Emulator::new().port(address.port()).start().unwrap();
        events.wait("device", |_| true);
        events.wait("columns", |_| true);
    });
}

#[test]
fn who_asks_nothing_keeps_nobody_out() {
    let server = Server::start(server::HERE).unwrap();
    let page = Page::of(server.url());
    let host = format!("Host: {}\r\n", page.host);
    // More than may wait, all of them silent.
    let silent: Vec<TcpStream> = (0..40).map(|_| TcpStream::connect(&page.host).unwrap()).collect();
    let mut events = (0..31).map(|_| page.events()).collect::<Vec<_>>();
    assert_eq!(page.asked(&format!("GET {}", page.path), &host, "").0, "200");
    // The page's own readers are counted, too, for themselves.
    events.push(page.events());
    assert_eq!(page.asked(&format!("GET {}", page.path), &host, "").0, "503");
    drop((silent, events));
}

#[test]
fn an_address_that_is_none_is_named() {
    for address in ["nowhere.invalid:1", "127.0.0.1:99999", "192.0.2.1"] {
        let error = Server::start(address).err().unwrap();
        assert!(error.to_string().contains(&format!("{address}: no page can be served there")), "{error}");
    }
    let taken = Server::start("127.0.0.1").unwrap();
    let host = Page::of(taken.url()).host;
    assert!(Server::start(&host).is_err());
}
