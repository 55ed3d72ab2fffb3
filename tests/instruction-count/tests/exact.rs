//! Programs with a known number of instructions, run and counted in QEMU.

use std::{env, fs, process::Command};

use serde_json::{Value, json};
use tempfile::TempDir;

/// Where a program starts, behind the stack pointer and the address of this very place.
const MAIN: u32 = 0x8;
/// The first instruction of the loop in which it calls.
const LOOP: u32 = 0xE;
/// Where it calls.
const CALL: u32 = 0x10;
/// What jumps to the function.
const JUMP: u32 = 0x80;
/// The function that is measured.
const FUNCTION: u32 = 0x100;
/// What that calls.
const CALLEE: u32 = 0x1000;

const NOP: u16 = 0xBF00;
const NOPS: usize = 1000;
/// Instructions of [`function`] from end to end, and of its early return.
const LONG: usize = 7 + NOPS;
const SHORT: usize = 3;

#[test]
fn calls_are_counted_to_the_instruction() {
    let counts = count(&[(MAIN, &main(bl(CALL, FUNCTION)))], None);
    assert_eq!(counts, [json!({"calls": 4, "jumps": 0, "min": SHORT, "max": LONG, "sum": 3 * LONG + SHORT})]);
}

#[test]
fn a_call_through_a_register_is_a_call() {
    let blx_r5 = [0x47A8, NOP];
    let counts = count(&[(MAIN, &main(blx_r5))], None);
    assert_eq!(counts, [json!({"calls": 4, "jumps": 0, "min": SHORT, "max": LONG, "sum": 3 * LONG + SHORT})]);
}

#[test]
fn a_jump_is_reported_and_not_measured() {
    let counts = count(&[(MAIN, &main(bl(CALL, JUMP))), (JUMP, &b(JUMP, FUNCTION))], None);
    assert_eq!(counts, [json!({"calls": 0, "jumps": 4, "min": 0, "max": 0, "sum": 0})]);
}

#[test]
fn counting_starts_anew_at_a_mark() {
    let counts = count(&[(MAIN, &main(bl(CALL, FUNCTION)))], Some(LOOP));
    let none = json!({"calls": 0, "jumps": 0, "min": 0, "max": 0, "sum": 0});
    let of = |length: usize| json!({"calls": 1, "jumps": 0, "min": length, "max": length, "sum": length});
    assert_eq!(counts, [none, of(LONG), of(SHORT), of(LONG), of(LONG)]);
}

/// Calls with r0 = 4, 3, 2, 1 and ends the emulator.
fn main(call: [u16; 2]) -> Vec<u16> {
    vec![
        0xF240, 0x1501, // movw r5, #FUNCTION + 1
        0x2404, // movs r4, #4
        0x4620, // loop: mov r0, r4
        call[0], call[1], // call
        0x3C01,  // subs r4, #1
        0xD1FA,  // bne loop
        0x2018,  // movs r0, #0x18   semihosting: exit
        0x4901,  // ldr r1, reason
        0xBEAB,  // bkpt #0xab
        NOP, 0x0026, 0x0002, // reason: .word 0x20026   of the program's own accord
    ]
}

/// Returns early where r0 = 3.
fn function() -> Vec<u16> {
    let start = [
        0x2803, // cmp r0, #3
        0xD100, // bne long
        0x4770, // bx lr
        0xB510, // long: push {r4, lr}
    ];
    let call = FUNCTION + 2 * (start.len() + NOPS) as u32;
    [&start[..], &[NOP; NOPS], &bl(call, CALLEE), &[/* pop {r4, pc} */ 0xBD10]].concat()
}

/// The instruction `bl` forwards.
fn bl(from: u32, to: u32) -> [u16; 2] {
    branch(0xF800, from, to)
}

/// The instruction `b.w` forwards.
fn b(from: u32, to: u32) -> [u16; 2] {
    branch(0xB800, from, to)
}

fn branch(kind: u16, from: u32, to: u32) -> [u16; 2] {
    let halfwords = (to - from - 4) / 2;
    [0xF000 | (halfwords >> 11) as u16, kind | (halfwords & 0x7FF) as u16]
}

/// Runs a program of these pieces, the function and what it calls, and returns what the plugin counted of the function.
fn count(pieces: &[(u32, &[u16])], mark: Option<u32>) -> Vec<Value> {
    let folder = TempDir::new().unwrap();
    let [image, out] = ["image", "counts.json"].map(|name| folder.path().join(name));
    let mut memory = vec![0; 0x2000];
    let function = function();
    let callee = [NOP, /* bx lr */ 0x4770];
    let vectors = [0x0000, 0x2001, MAIN as u16 + 1, 0x0000];
    let rest: [(u32, &[u16]); 3] = [(0, &vectors), (FUNCTION, &function), (CALLEE, &callee)];
    for (address, halfwords) in rest.iter().chain(pieces) {
        for (place, halfword) in memory[*address as usize..].chunks_mut(2).zip(*halfwords) {
            place.copy_from_slice(&halfword.to_le_bytes());
        }
    }
    fs::write(&image, memory).unwrap();

    // Cargo puts the plugin beside this test's program.
    let plugin = env::current_exe().unwrap().with_file_name("libinstruction_count.so");
    let mut options = format!("{},function={FUNCTION:#x},out={}", plugin.display(), out.display());
    if let Some(mark) = mark {
        options += &format!(",mark={mark:#x}");
    }
    let status = Command::new("qemu-system-arm")
        .args(["-M", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-plugin", &options, "-kernel"])
        .arg(image)
        .status()
        .expect("`cargo xtask setup` gets QEMU");
    assert!(status.success(), "{status}");
    fs::read_to_string(out).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}
