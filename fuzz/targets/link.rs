#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let clock = embassy_time::MockDriver::get();
    clock.reset();
    let _ = fuzzed::link::check(bytes, &|time| clock.advance(time));
});
