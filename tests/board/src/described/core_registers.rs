//! The core's registers, with the crate `cortex-m`.

use std::mem::offset_of;

use cortex_m::peripheral::{DCB, DWT, NVIC, SCB, dcb, dwt, nvic, scb};

use crate::{bases, bus, layout::Peripheral, nvic as model};

/// Registers by the manual's names, and their addresses.
fn described() -> Vec<(&'static str, usize)> {
    macro_rules! addresses {
        ($($block:ident as $module:ident { $($name:literal = $field:ident),* })*) => {
            vec![$($(($name, $block::PTR as usize + offset_of!($module::RegisterBlock, $field))),*),*]
        };
    }
    addresses! {
        NVIC as nvic { "ISER" = iser, "ICER" = icer, "ISPR" = ispr, "ICPR" = icpr, "IPR" = ipr }
        SCB as scb { "ICSR" = icsr, "AIRCR" = aircr, "CFSR" = cfsr, "BFAR" = bfar, "CPACR" = cpacr }
        DCB as dcb { "DEMCR" = demcr }
        DWT as dwt { "CTRL" = ctrl, "CYCCNT" = cyccnt }
    }
}

#[test]
fn every_register_of_the_core_is_where_cortex_m_has_it() {
    let of = |layout: &'static [Peripheral], base: u32| {
        let registers = layout.iter().flat_map(|peripheral| peripheral.registers);
        registers.map(move |register| (register.name, (base + register.offset) as usize))
    };
    let modelled: Vec<_> = of(model::LAYOUT, bases::SCS).chain(of(bus::LAYOUT, bases::DWT)).collect();
    assert_eq!(modelled, described());
}
