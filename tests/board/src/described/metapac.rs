//! The crate `stm32-metapac`: embassy's description, made of ST's headers and of the SVD files, with names that
//! all chips share.

use stm32_metapac::metadata::{METADATA, ir};

use super::Description;

/// Of arrays it counts the elements from 0, and names are as short as all chips' have them.
const SPELLING: &[(&str, &[(&str, &str)])] = &[
    ("", &[("DMAMUX", "DMAMUX1")]),
    ("INTERRUPT", &[("DMA1_CH1", "DMA1_CHANNEL1"), ("DMA1_CH2", "DMA1_CHANNEL2"), ("DMA1_CH3", "DMA1_CHANNEL3")]),
    (
        "ADC1",
        &[
            ("SMPR1", "SMPR"),
            ("SMPR1.SMP0", "SMPR.SMP[0]"),
            ("SMPR1.SMP9", "SMPR.SMP[9]"),
            ("SMPR2.SMP10", "SMPR2.SMP[0]"),
            ("SMPR2.SMP18", "SMPR2.SMP[8]"),
            ("SQR1.SQ1", "SQR1.SQ[0]"),
            ("JSQR.JSQ1", "JSQR.JSQ[0]"),
            ("JSQR.JSQ2", "JSQR.JSQ[1]"),
            ("JSQR.JSQ3", "JSQR.JSQ[2]"),
            ("JDR1", "JDR[0]"),
            ("JDR2", "JDR[1]"),
            ("JDR3", "JDR[2]"),
        ],
    ),
    (
        "DAC1",
        &[
            ("CR.EN1", "CR.EN[0]"),
            ("CR.TEN1", "CR.TEN[0]"),
            ("CR.TSEL1", "CR.TSEL[0]"),
            ("CR.DMAEN1", "CR.DMAEN[0]"),
            ("DHR12R1.DACC1DHR", "DHR12R[0].DHR"),
            ("DHR12R1", "DHR12R[0]"),
            ("DOR1", "DOR[0]"),
            ("SR.DMAUDR1", "SR.DMAUDR[0]"),
            ("MCR.MODE1", "MCR.MODE[0]"),
        ],
    ),
    (
        "DMA1",
        &[
            ("ISR.GIF1", "ISR.GIF[0]"),
            ("ISR.TCIF1", "ISR.TCIF[0]"),
            ("ISR.HTIF1", "ISR.HTIF[0]"),
            ("ISR.TEIF1", "ISR.TEIF[0]"),
            ("ISR.GIF2", "ISR.GIF[1]"),
            ("ISR.GIF8", "ISR.GIF[7]"),
            ("ISR.TCIF8", "ISR.TCIF[7]"),
            ("ISR.HTIF8", "ISR.HTIF[7]"),
            ("ISR.TEIF8", "ISR.TEIF[7]"),
            ("IFCR.CGIF1", "IFCR.GIF[0]"),
            ("IFCR.CTCIF1", "IFCR.TCIF[0]"),
            ("IFCR.CHTIF1", "IFCR.HTIF[0]"),
            ("IFCR.CTEIF1", "IFCR.TEIF[0]"),
            ("IFCR.CGIF8", "IFCR.GIF[7]"),
            ("IFCR.CTCIF8", "IFCR.TCIF[7]"),
            ("IFCR.CHTIF8", "IFCR.HTIF[7]"),
            ("IFCR.CTEIF8", "IFCR.TEIF[7]"),
            ("CCR1", "CH[0].CR"),
            ("CNDTR1", "CH[0].NDTR"),
            ("CPAR1", "CH[0].PAR"),
            ("CMAR1", "CH[0].MAR"),
            ("CCR2", "CH[1].CR"),
            ("CCR8", "CH[7].CR"),
            ("CMAR8", "CH[7].MAR"),
        ],
    ),
    ("DMAMUX", &[("C0CR", "CCR[0]"), ("C7CR", "CCR[7]")]),
    (
        "GPIOA",
        &[
            ("MODER.MODER0", "MODER.MODER[0]"),
            ("MODER.MODER15", "MODER.MODER[15]"),
            ("IDR.IDR0", "IDR.IDR[0]"),
            ("IDR.IDR15", "IDR.IDR[15]"),
            ("ODR.ODR0", "ODR.ODR[0]"),
            ("ODR.ODR15", "ODR.ODR[15]"),
            ("BSRR.BS0", "BSRR.BS[0]"),
            ("BSRR.BS15", "BSRR.BS[15]"),
            ("BSRR.BR0", "BSRR.BR[0]"),
            ("BSRR.BR15", "BSRR.BR[15]"),
        ],
    ),
    (
        "LPUART1",
        &[("ICR.FECF", "ICR.FE"), ("ICR.ORECF", "ICR.ORE"), ("ICR.IDLECF", "ICR.IDLE"), ("ICR.TCCF", "ICR.TC")],
    ),
    ("RCC", &[("PLLCFGR.PLLPDIV", "PLLCFGR.PLLP"), ("PLLCFGR.PLLP", "PLLCFGR.PLLP17")]),
    (
        "TIM5",
        &[
            ("DIER.CC1IE", "DIER.CCIE[0]"),
            ("DIER.CC2IE", "DIER.CCIE[1]"),
            ("DIER.CC3IE", "DIER.CCIE[2]"),
            ("DIER.CC4IE", "DIER.CCIE[3]"),
            ("SR.CC1IF", "SR.CCIF[0]"),
            ("SR.CC2IF", "SR.CCIF[1]"),
            ("SR.CC3IF", "SR.CCIF[2]"),
            ("SR.CC4IF", "SR.CCIF[3]"),
            ("EGR.CC1G", "EGR.CCG[0]"),
            ("EGR.CC2G", "EGR.CCG[1]"),
            ("EGR.CC3G", "EGR.CCG[2]"),
            ("EGR.CC4G", "EGR.CCG[3]"),
            ("CCR1", "CCR[0]"),
            ("CCR4", "CCR[3]"),
        ],
    ),
];
/// BRR of the ports, which ST's header has; and the bit of the PLL's P that stands for 7 or 17 where PLLPDIV is 0.
const ABSENT: &[&str] = &[
    "GPIOA.BRR",
    "GPIOA.BRR.BR0",
    "GPIOA.BRR.BR15",
    "GPIOB.BRR",
    "GPIOB.BRR.BR0",
    "GPIOB.BRR.BR15",
    "GPIOC.BRR",
    "GPIOC.BRR.BR0",
    "GPIOC.BRR.BR15",
    "RCC.PLLCFGR.PLLP",
];
const DIFFERS: &[(&str, u32)] = &[
    // Bit 0: its error, for which the firmware sets the clocks itself; ST's headers have bit 8 as the manual does.
    ("PWR.CR5.R1MODE", 1 << 0),
    // Eight bits, as on chips with more requests.
    ("DMAMUX.C0CR.DMAREQ_ID", 0xFF),
    // The other U(S)ARTs' 16 bits.
    ("LPUART1.BRR.BRR", 0xFFFF),
    // With the fourth bit that lies apart, for triggers that no model has.
    ("TIM5.CR2.MMS", 7 << 4 | 1 << 25),
    ("TIM6.CR2.MMS", 7 << 4 | 1 << 25),
    ("TIM7.CR2.MMS", 7 << 4 | 1 << 25),
];

/// What it says of the peripherals.
pub fn read() -> Description {
    let mut description = Description {
        name: "stm32-metapac",
        spelling: SPELLING,
        absent: ABSENT,
        differs: DIFFERS,
        ..Description::default()
    };
    for peripheral in METADATA.peripherals {
        description.bases.insert(peripheral.name.to_owned(), peripheral.address as u32);
        if let Some(registers) = &peripheral.registers {
            block(&mut description, registers.ir, peripheral.name, &registers.block.replace('_', ""), 0);
        }
    }
    description.interrupts =
        METADATA.interrupts.iter().map(|one| (format!("INTERRUPT.{}", one.name), one.number)).collect();
    description
}

/// The request for DMA that a peripheral's signal makes.
pub fn request(peripheral: &str, signal: &str) -> Option<u32> {
    let channels = METADATA.peripherals.iter().find(|one| one.name == peripheral)?.dma_channels;
    channels.iter().find(|one| one.signal == signal)?.request
}

/// The registers and blocks of a block, and of the one that it extends.
fn block(description: &mut Description, ir: &ir::IR, name: &str, of: &str, offset: u32) {
    let Some(found) = ir.blocks.iter().find(|block| block.name.eq_ignore_ascii_case(of)) else { return };
    if let Some(general) = found.extends {
        block(description, ir, name, general, offset);
    }
    for item in found.items {
        for (index, further) in places(item.array.as_ref()) {
            let path = format!("{name}.{}{index}", item.name.to_uppercase());
            let offset = offset + item.byte_offset + further;
            match &item.inner {
                ir::BlockItemInner::Block(inner) => block(description, ir, &path, inner.block, offset),
                ir::BlockItemInner::Register(register) => {
                    description.registers.insert(path.clone(), offset);
                    if let Some(of) = register.fieldset {
                        fields(description, ir, &path, of);
                    }
                }
            }
        }
    }
}

/// The fields of a register, and of the set that its own extends.
fn fields(description: &mut Description, ir: &ir::IR, register: &str, of: &str) {
    let Some(found) = ir.fieldsets.iter().find(|set| set.name == of) else { return };
    if let Some(general) = found.extends {
        fields(description, ir, register, general);
    }
    for field in found.fields {
        for (index, further) in places(field.array.as_ref()) {
            let ones = |low: u32, width: u32| (u32::MAX >> (32 - width)) << low;
            let mask = match &field.bit_offset {
                ir::BitOffset::Regular(bits) => ones(bits.offset, field.bit_size),
                ir::BitOffset::Cursed(bits) => {
                    bits.ranges.iter().map(|range| ones(*range.start(), range.end() - range.start() + 1)).sum()
                }
            };
            description.fields.insert(format!("{register}.{}{index}", field.name.to_uppercase()), mask << further);
        }
    }
}

/// What stands behind a name, and how far each of an array's elements is behind its first.
fn places(array: Option<&ir::Array>) -> Vec<(String, u32)> {
    let offsets: Vec<u32> = match array {
        None => return vec![(String::new(), 0)],
        Some(ir::Array::Regular(array)) => (0..array.len).map(|n| n * array.stride).collect(),
        Some(ir::Array::Cursed(array)) => array.offsets.to_vec(),
    };
    (0..).zip(offsets).map(|(n, offset): (u32, u32)| (format!("[{n}]"), offset)).collect()
}
