//! QEMU's plugin interface as far as it is used here, after `qemu-plugin.h`, which Debian's QEMU comes without.

use std::ffi::{c_char, c_int, c_uint, c_void};

use crate::instruction::Instruction;

/// A block of instructions that QEMU is translating.
#[repr(C)]
pub struct Block {
    _opaque: [u8; 0],
}

/// An instruction of a [`Block`].
#[repr(C)]
struct Handle {
    _opaque: [u8; 0],
}

/// Called with each block that QEMU translates.
pub type Translated = extern "C" fn(plugin: u64, block: *mut Block);
/// Called with the data given before an instruction runs.
pub type Execute = extern "C" fn(cpu: c_uint, data: *mut c_void);
/// Called when QEMU ends.
pub type Exit = extern "C" fn(plugin: u64, data: *mut c_void);

unsafe extern "C" {
    fn qemu_plugin_register_vcpu_tb_trans_cb(plugin: u64, callback: Translated);
    fn qemu_plugin_register_atexit_cb(plugin: u64, callback: Exit, data: *mut c_void);
    fn qemu_plugin_register_vcpu_insn_exec_cb(handle: *mut Handle, callback: Execute, flags: c_int, data: *mut c_void);
    fn qemu_plugin_tb_n_insns(block: *const Block) -> usize;
    fn qemu_plugin_tb_get_insn(block: *const Block, index: usize) -> *mut Handle;
    fn qemu_plugin_insn_vaddr(handle: *const Handle) -> u64;
    fn qemu_plugin_insn_size(handle: *const Handle) -> usize;
    fn qemu_plugin_insn_haddr(handle: *const Handle) -> *const c_void;
    fn dlsym(library: *mut c_void, symbol: *const c_char) -> *mut c_void;
}

/// The version of the interface to ask for: 2 from QEMU 9 on, which refuses 1, and 1 before.
pub fn version() -> c_int {
    // SAFETY: null stands for every library that is loaded, QEMU among them, and the name ends in a NUL.
    let new_in_2 = unsafe { dlsym(std::ptr::null_mut(), c"qemu_plugin_scoreboard_new".as_ptr()) };
    if new_in_2.is_null() { 1 } else { 2 }
}

/// Registers what is to be called.
///
/// # Safety
/// `plugin` is the number that QEMU gave this plugin.
pub unsafe fn register(plugin: u64, translated: Translated, exit: Exit) {
    // SAFETY: as the caller promises; the callbacks are functions, which last as long as the plugin.
    unsafe {
        qemu_plugin_register_vcpu_tb_trans_cb(plugin, translated);
        qemu_plugin_register_atexit_cb(plugin, exit, std::ptr::null_mut());
    }
}

/// Has every instruction of a block announced before it runs, with [`Instruction::to_data`] of it.
///
/// # Safety
/// `block` is what QEMU has just passed to [`Translated`].
pub unsafe fn announce(block: *mut Block, execute: Execute) {
    /// The callback reads no register.
    const NO_REGISTERS: c_int = 0;
    // SAFETY: the block is valid during the call that passed it, and so is each instruction below its length.
    unsafe {
        for index in 0..qemu_plugin_tb_n_insns(block) {
            let handle = qemu_plugin_tb_get_insn(block, index);
            qemu_plugin_register_vcpu_insn_exec_cb(handle, execute, NO_REGISTERS, instruction(handle).to_data());
        }
    }
}

/// # Safety
/// `handle` is valid.
unsafe fn instruction(handle: *const Handle) -> Instruction {
    // SAFETY: as the caller promises. QEMU maps the guest's memory, from which it has just read the instruction, at the
    // address it names, whose halfwords are little-endian and aligned; it has none for code in a device's registers.
    unsafe {
        let halfwords: *const u16 = qemu_plugin_insn_haddr(handle).cast();
        let halfword = |index| u32::from(u16::from_le(halfwords.add(index).read()));
        let code = match qemu_plugin_insn_size(handle) {
            _ if halfwords.is_null() => 0,
            2 => halfword(0),
            _ => halfword(0) << 16 | halfword(1),
        };
        // A Cortex-M has 32 bits of address.
        Instruction { address: qemu_plugin_insn_vaddr(handle) as u32, code }
    }
}
