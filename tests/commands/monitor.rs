//! `piezo monitor` beside its terminal: datagrams, and the page's address.

use super::{piezo, refused, text};
use emulator::Emulator;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpStream, UdpSocket};
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// What `monitor --udp` sends in a second, and what it prints meanwhile.
fn sent(options: &[&str]) -> (Vec<String>, String) {
    let device = Emulator::new().start().unwrap();
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    let (to, port) = (receiver.local_addr().unwrap().to_string(), format!("tcp:{}", device.address()));
    let reads = std::thread::spawn(move || {
        let (mut datagrams, mut buffer) = (Vec::new(), [0; 2048]);
        receiver.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        while let Ok((length, _)) = receiver.recv_from(&mut buffer) {
            datagrams.push(String::from_utf8(buffer[..length].to_vec()).unwrap());
            receiver.set_read_timeout(Some(Duration::from_millis(800))).unwrap();
        }
        datagrams
    });
    let monitor = ["monitor", "--seconds", "1", "--udp", &to, "--port", &port];
    let output = piezo().args(monitor).args(options).assert().success().get_output().stdout.clone();
    (reads.join().unwrap(), String::from_utf8(output).unwrap())
}

#[test]
fn plotjuggler_is_sent_every_tick_beside_the_terminal() {
    let (datagrams, printed) = sent(&["--format", "plotjuggler", "--every", "1"]);
    assert!(printed.contains(" samples, "), "{printed}");
    let ticks: Vec<Value> = datagrams.iter().map(|datagram| serde_json::from_str(datagram).unwrap()).collect();
    assert!(ticks.len() > 200, "{}", ticks.len());
    let time = |tick: &Value| tick["timestamp"].as_f64().unwrap();
    let apart = ticks.windows(2).filter(|pair| (time(&pair[1]) - time(&pair[0]) - 5e-4).abs() < 1e-6).count();
    // A datagram may be lost.
    assert!(10 * apart > 9 * ticks.len(), "{apart} of {}", ticks.len());
    assert!(ticks.iter().all(|tick| tick["piezo"]["voltage_V"].is_number()), "{}", ticks[0]);
}

#[test]
fn teleplot_is_sent_a_few_ticks_of_each_ten() {
    let (datagrams, _) = sent(&[]);
    let points: usize =
        datagrams.iter().map(|datagram| datagram.lines().next().unwrap().matches(';').count() + 1).sum();
    assert!(datagrams.len() > 20 && points <= 5 * datagrams.len(), "{points} in {}", datagrams.len());
    assert!(datagrams[0].starts_with("voltage:") && datagrams[0].contains("§V\ndisplacement:"), "{}", datagrams[0]);
}

#[test]
fn the_page_s_address_is_one_line_and_what_is_wrong_is_named() {
    let device = Emulator::new().start().unwrap();
    let port = format!("tcp:{}", device.address());
    let monitor = |options: &[&str]| {
        let output = piezo().args(["monitor", "--port", &port]).args(options).assert().success().get_output().clone();
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (said, careful) = monitor(&["--seconds", "0.3", "--web"]);
    assert!(said.lines().count() == 1 && said.starts_with("The scope is at http://127.0.0.1:"), "{said}");
    assert!(!careful.contains("other machines"), "{careful}");
    let (_, careful) = monitor(&["--seconds", "0.3", "--web", "0.0.0.0"]);
    assert!(careful.contains("other machines reach this page"), "{careful}");

    let refused = |options: &[&str], says: &[&str]| refused(&[&["monitor", "--port", &port], options].concat(), says);
    refused(&["--web", "192.0.2.1:80"], &["192.0.2.1:80", "no page can be served there"]);
    refused(&["--udp", "nowhere"], &["nowhere", "no address"]);
    refused(&["--udp", "127.0.0.1:1", "--every", "0"], &["--every"]);
    refused(&["--udp", "127.0.0.1:1", "--every", "2001"], &["--every", "2000"]);
    refused(&["--every", "5"], &["--udp"]);
    refused(&["--web", "--json"], &["--json"]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    refused(&["--web", "--out", text(&file)], &["file", "cannot create the folder"]);
}

/// What `monitor --web` says in the end of a recording that is under way then, after `meanwhile`; whether it ends well.
fn recorded(folder: &Path, meanwhile: impl FnOnce()) -> (bool, String) {
    let device = Emulator::new().start().unwrap();
    let port = format!("tcp:{}", device.address());
    let mut process = std::process::Command::new(env!("CARGO_BIN_EXE_piezo"))
        .args(["monitor", "--web", "--seconds", "5", "--out", text(folder), "--port", &port])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(process.stdout.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let url = line.split(' ').find_map(|word| word.strip_prefix("http://")).unwrap();
    let (host, path) = url.split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let body = r#"{"on": true}"#;
    let head = format!("POST /{path}record HTTP/1.1\r\nHost: {host}\r\nContent-Length: {}\r\n\r\n", body.len());
    stream.write_all((head + body).as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    meanwhile();
    let mut rest = String::new();
    said.read_to_string(&mut rest).unwrap();
    process.stderr.take().unwrap().read_to_string(&mut rest).unwrap();
    (process.wait().unwrap().success(), rest)
}

#[test]
fn what_becomes_of_a_recording_at_the_end_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let (well, said) = recorded(folder.path(), || {});
    assert!(well && said.contains("recording-1.csv holds "), "{said}");
    assert!(folder.path().join("recording-1.csv").is_file());
}

/// Elsewhere a folder with an open file in it stays.
#[cfg(target_os = "linux")]
#[test]
fn a_recording_that_is_not_there_in_the_end_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let gone = folder.path().join("gone");
    std::fs::create_dir(&gone).unwrap();
    let (well, said) = recorded(&gone, || std::fs::remove_dir_all(&gone).unwrap());
    assert!(!well && said.contains("recording-1.csv: cannot be written"), "{said}");
}
