//! A plugin for QEMU's Cortex-M machines that counts the instructions of every call of one function, exactly.
//!
//! ```text
//! qemu-system-arm … -plugin libinstruction_count.so,function=0xADDRESS,out=FILE[,mark=0xADDRESS]
//! ```
//!
//! Addresses are those of instructions, without the Thumb bit. `counter.rs` says what counts as a call. FILE is written
//! when QEMU ends in an orderly way: by the guest, by the monitor's `quit`, or by SIGTERM.
//!
//! For Linux. Nothing of QEMU's is linked; QEMU lends its own functions to the plugins that it loads.

mod counter;
mod instruction;
mod options;
mod qemu;

use std::{
    ffi::{c_char, c_int, c_uint, c_void},
    fs::File,
    io::Write,
    sync::{
        Mutex,
        atomic::{AtomicI32, Ordering},
    },
};

use counter::Counter;
use instruction::Instruction;
use options::Options;
use qemu::Block;

/// The version of its plugin interface that QEMU shall provide. QEMU reads it before it calls anything.
#[unsafe(no_mangle)]
pub static qemu_plugin_version: AtomicI32 = AtomicI32::new(0);

/// Runs while the plugin is loaded: which version suits depends on the QEMU that does so.
#[used]
#[unsafe(link_section = ".init_array")]
static ON_LOAD: extern "C" fn() = choose_version;

extern "C" fn choose_version() {
    qemu_plugin_version.store(qemu::version(), Ordering::Relaxed);
}

static COUNT: Mutex<Option<(Counter, File)>> = Mutex::new(None);

/// Called by QEMU once the plugin is loaded. Anything but 0 keeps QEMU from starting.
///
/// # Safety
/// `arguments` points to `count` pointers to strings that end in a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    plugin: u64,
    _info: *const c_void,
    count: c_int,
    arguments: *const *const c_char,
) -> c_int {
    // SAFETY: as the caller promises.
    let strings = unsafe { options::strings(count, arguments) };
    match strings.and_then(|strings| Options::parse(strings.into_iter())) {
        Ok(Options { function, mark, out }) => {
            with_count(|count| *count = Some((Counter::new(function, mark), out)));
            // SAFETY: the number is the one that QEMU has just given.
            unsafe { qemu::register(plugin, translated, exit) };
            0
        }
        Err(message) => {
            eprintln!("instruction-count: {message}");
            1
        }
    }
}

extern "C" fn translated(_plugin: u64, block: *mut Block) {
    // SAFETY: the block is the one that QEMU has just passed.
    unsafe { qemu::announce(block, execute) };
}

extern "C" fn execute(_cpu: c_uint, data: *mut c_void) {
    with_count(|count| {
        if let Some((counter, _)) = count {
            counter.execute(Instruction::from_data(data));
        }
    });
}

extern "C" fn exit(_plugin: u64, _data: *mut c_void) {
    with_count(|count| {
        if let Some((counter, out)) = count
            && let Err(error) = write!(out, "{counter}")
        {
            eprintln!("instruction-count: {error}");
        }
    });
}

fn with_count(f: impl FnOnce(&mut Option<(Counter, File)>)) {
    // Nothing that holds the lock panics.
    f(&mut COUNT.lock().expect("no holder panics"));
}
