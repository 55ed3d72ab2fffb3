//! What an instruction costs the core by itself, and what it needs of the one before it.
//!
//! Costs after Arm's Cortex-M4 Technical Reference Manual (DDI 0439), tables 3-1 and 7-1: one clock but for those
//! below. Where the manual gives a range, or leaves it to the memory, both ends are kept.
//!
//! | instruction | clocks |
//! |---|---|
//! | load of a word; store | 2; 1 to 2, where the write buffer is full |
//! | of n words (LDM, STM, PUSH, POP, LDRD, STRD and those of the FPU) | 1 + n |
//! | integer division | 2 to 12 |
//! | VDIV, VSQRT | 14 |
//! | fused or chained multiply and add of the FPU | 3 |
//! | MLA, MLS; barriers; MRS, MSR | 1 to 2; 1 to 5; 1 to 2 |
//! | branch | 1, and the pipeline's refill ([`super::pipeline`]) |

use anyhow::{Context, Result};
use capstone::{
    Capstone, Insn, RegId,
    arch::{
        self, BuildsCapstone, BuildsCapstoneExtraMode, DetailsArchInsn,
        arm::{ArmInsn, ArmOperandType, ArmReg},
    },
};

/// An instruction as the pipeline sees it.
pub struct Instruction {
    /// Length in bytes, 2 or 4.
    pub size: u32,
    /// Clocks at least and at most.
    pub clocks: (u64, u64),
    /// It loads a word into this register.
    pub loads: Option<RegId>,
    /// It leaves a result of the FPU in this register.
    pub computes: Option<RegId>,
    /// It compares in the FPU.
    pub compares: bool,
    /// Registers that it reads.
    pub reads: Vec<RegId>,
    /// Where it is an IT: how many bytes from here each instruction under its condition begins, and the
    /// one behind them.
    pub conditional: Vec<u32>,
}

/// Instructions under one IT at most.
const MOST_CONDITIONAL: usize = 4;
/// Bytes to [decode](Decoder::decode) an instruction from: an IT of two, those under it and the one behind
/// of four each.
pub const ENOUGH: usize = 2 + 4 * (MOST_CONDITIONAL + 1);

/// Decodes an image's instructions.
pub struct Decoder(Capstone);

impl Decoder {
    /// Of Thumb code for the M profile.
    ///
    /// # Errors
    /// The library cannot be had.
    pub fn new() -> Result<Self> {
        let builder = Capstone::new().arm().mode(arch::arm::ArchMode::Thumb);
        let decoder = builder.extra_mode([arch::arm::ArchExtraMode::MClass].into_iter()).detail(true).build();
        Ok(Self(decoder.context("capstone does not start")?))
    }

    /// The instruction that begins with these bytes, at an address; of an IT those under its condition, too.
    ///
    /// # Errors
    /// There is none.
    pub fn decode(&self, bytes: &[u8], address: u32) -> Result<Instruction> {
        let found = self.0.disasm_count(bytes, address.into(), 2 + MOST_CONDITIONAL)?;
        let instruction = found.first().with_context(|| format!("no instruction at {address:#x}"))?;
        let mut behind = found.iter().map(|instruction| (instruction.address() as u32).wrapping_sub(address));
        // "itte" has three; the one behind them may be no instruction.
        let count = if instruction.id().0 == ArmInsn::ARM_INS_IT as u32 { instruction.bytes()[0] & 0xF } else { 0 };
        let count = if count == 0 { 0 } else { 4 - count.trailing_zeros() as usize };
        let conditional = if count == 0 { Vec::new() } else { behind.by_ref().skip(1).take(count + 1).collect() };
        self.instruction(instruction, conditional)
    }

    fn instruction(&self, of: &Insn<'_>, conditional: Vec<u32>) -> Result<Instruction> {
        let detail = self.0.insn_detail(of)?;
        let arch = detail.arch_detail();
        let operands: Vec<ArmOperandType> =
            arch.arm().context("not Arm's")?.operands().map(|operand| operand.op_type).collect();
        let id = of.id().0;
        let loads = LOADS.iter().any(|&load| id == load as u32);
        let computes = COMPUTES.iter().any(|&sum| id == sum as u32);
        let registers = registers(&operands);
        let first = registers.first().copied();
        // What it adds to, it reads; what it stores or compares, too. A register read once too often costs a
        // clock too many.
        let skipped = usize::from(loads || computes && !MULTIPLY_ADD.iter().any(|&sum| id == sum as u32));
        Ok(Instruction {
            size: of.len() as u32,
            clocks: clocks(id, &operands, loads),
            loads: first.filter(|_| loads),
            computes: first.filter(|_| computes),
            compares: [ArmInsn::ARM_INS_VCMP, ArmInsn::ARM_INS_VCMPE].iter().any(|&compare| id == compare as u32),
            reads: registers.into_iter().skip(skipped).collect(),
            conditional,
        })
    }
}

const LOADS: [ArmInsn; 6] = [
    ArmInsn::ARM_INS_LDR,
    ArmInsn::ARM_INS_LDRB,
    ArmInsn::ARM_INS_LDRH,
    ArmInsn::ARM_INS_LDRSB,
    ArmInsn::ARM_INS_LDRSH,
    ArmInsn::ARM_INS_LDRT,
];
const MULTIPLY_ADD: [ArmInsn; 8] = [
    ArmInsn::ARM_INS_VMLA,
    ArmInsn::ARM_INS_VMLS,
    ArmInsn::ARM_INS_VNMLA,
    ArmInsn::ARM_INS_VNMLS,
    ArmInsn::ARM_INS_VFMA,
    ArmInsn::ARM_INS_VFMS,
    ArmInsn::ARM_INS_VFNMA,
    ArmInsn::ARM_INS_VFNMS,
];
/// Of the FPU, with a result that the next instruction has to wait for.
const COMPUTES: [ArmInsn; 15] = [
    ArmInsn::ARM_INS_VADD,
    ArmInsn::ARM_INS_VSUB,
    ArmInsn::ARM_INS_VMUL,
    ArmInsn::ARM_INS_VNMUL,
    ArmInsn::ARM_INS_VCVT,
    ArmInsn::ARM_INS_VDIV,
    ArmInsn::ARM_INS_VSQRT,
    MULTIPLY_ADD[0],
    MULTIPLY_ADD[1],
    MULTIPLY_ADD[2],
    MULTIPLY_ADD[3],
    MULTIPLY_ADD[4],
    MULTIPLY_ADD[5],
    MULTIPLY_ADD[6],
    MULTIPLY_ADD[7],
];

/// Registers in their order, those of an address included.
fn registers(operands: &[ArmOperandType]) -> Vec<RegId> {
    let each = |operand: &ArmOperandType| match operand {
        ArmOperandType::Reg(register) => vec![*register],
        ArmOperandType::Mem(address) => vec![address.base(), address.index()],
        _ => Vec::new(),
    };
    operands.iter().flat_map(each).filter(|register| register.0 != 0).collect()
}

/// Clocks at least and at most.
fn clocks(id: u32, operands: &[ArmOperandType], loads: bool) -> (u64, u64) {
    use ArmInsn::*;
    let is = |instructions: &[ArmInsn]| instructions.iter().any(|&other| id == other as u32);
    let double = |operand: &&ArmOperandType| {
        let doubles = ArmReg::ARM_REG_D0 as u16..=ArmReg::ARM_REG_D31 as u16;
        matches!(operand, ArmOperandType::Reg(register) if doubles.contains(&register.0))
    };
    let registers = operands.iter().filter(|operand| matches!(operand, ArmOperandType::Reg(_))).count();
    let words = (registers + operands.iter().filter(double).count()) as u64;
    if is(&[ARM_INS_VDIV, ARM_INS_VSQRT]) {
        (14, 14)
    } else if is(&MULTIPLY_ADD) {
        (3, 3)
    } else if is(&[ARM_INS_VLDR, ARM_INS_VSTR, ARM_INS_PUSH, ARM_INS_POP, ARM_INS_VPUSH, ARM_INS_VPOP]) {
        (1 + words, 1 + words)
    } else if is(&[ARM_INS_LDM, ARM_INS_LDMDB, ARM_INS_STM, ARM_INS_STMDB])
        || is(&[ARM_INS_VLDMIA, ARM_INS_VLDMDB, ARM_INS_VSTMIA, ARM_INS_VSTMDB])
    {
        // The first register is the address.
        (words, words)
    } else if is(&[ARM_INS_LDRD, ARM_INS_STRD]) {
        (3, 3)
    } else if loads || is(&[ARM_INS_TBB, ARM_INS_TBH]) {
        (2, 2)
    } else if is(&[ARM_INS_LDREX, ARM_INS_LDREXB, ARM_INS_LDREXH, ARM_INS_STREX, ARM_INS_STREXB, ARM_INS_STREXH]) {
        (2, 3)
    } else if is(&[ARM_INS_SDIV, ARM_INS_UDIV]) {
        (2, 12)
    } else if is(&[ARM_INS_DMB, ARM_INS_DSB, ARM_INS_ISB]) {
        (1, 5)
    } else if is(&[ARM_INS_STR, ARM_INS_STRB, ARM_INS_STRH, ARM_INS_MLA, ARM_INS_MLS, ARM_INS_MRS, ARM_INS_MSR])
        || (is(&[ARM_INS_VMOV]) && registers > 2)
    {
        (1, 2)
    } else {
        (1, 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> Instruction {
        let decoder = Decoder::new().expect("capstone starts");
        decoder.decode(bytes, 0x0800_0000).expect("it is an instruction")
    }

    #[test]
    fn instructions_cost_what_the_manual_says() {
        for (bytes, clocks, name) in [
            (&[0x80, 0xEE, 0x81, 0x0A][..], (14, 14), "vdiv.f32 s0, s1, s2"),
            (&[0x30, 0xEE, 0x81, 0x0A], (1, 1), "vadd.f32 s0, s1, s2"),
            (&[0x00, 0xEE, 0x81, 0x0A], (3, 3), "vmla.f32 s0, s1, s2"),
            (&[0x90, 0xED, 0x00, 0x0A], (2, 2), "vldr s0, [r0]"),
            (&[0x90, 0xED, 0x00, 0x0B], (3, 3), "vldr d0, [r0]"),
            (&[0x2D, 0xED, 0x04, 0x8B], (5, 5), "vpush {d8, d9}"),
            (&[0xF0, 0xB5], (6, 6), "push {r4-r7, lr}"),
            (&[0x0F, 0xC8], (5, 5), "ldm r0!, {r0-r3}"),
            (&[0x08, 0x68], (2, 2), "ldr r0, [r1]"),
            (&[0x08, 0x60], (1, 2), "str r0, [r1]"),
            (&[0x90, 0xFB, 0xF1, 0xF0], (2, 12), "sdiv r0, r0, r1"),
            (&[0x40, 0x18], (1, 1), "adds r0, r0, r1"),
        ] {
            assert_eq!(decoded(bytes).clocks, clocks, "{name}");
        }
    }

    #[test]
    fn what_waits_for_what_is_found() {
        let (add, load) = (decoded(&[0x30, 0xEE, 0x81, 0x0A]), decoded(&[0x08, 0x68]));
        assert!(add.computes.is_some_and(|s0| !add.reads.contains(&s0)) && add.reads.len() == 2);
        assert!(load.loads.is_some() && load.computes.is_none() && load.reads.len() == 1);
        let accumulate = decoded(&[0x00, 0xEE, 0x81, 0x0A]);
        assert!(accumulate.computes.is_some_and(|s0| accumulate.reads.contains(&s0)));
        // ite eq; moveq r0, r1; vmovne.f32 s0, s1; adds r0, r0, r1
        let ite = decoded(&[0x0C, 0xBF, 0x08, 0x46, 0xB0, 0xEE, 0x60, 0x0A, 0x40, 0x18]);
        assert_eq!(ite.conditional, [2, 4, 8]);
        assert!(decoded(&[0xB4, 0xEE, 0x60, 0x0A]).compares, "vcmp.f32 s0, s1");
    }
}
