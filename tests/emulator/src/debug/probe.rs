//! A probe of probe-rs whose wires lead to the emulated chip.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use probe_rs::MemoryInterface;
use probe_rs::architecture::arm::ap::CSW;
use probe_rs::architecture::arm::dp::{DpAddress, DpRegisterAddress};
use probe_rs::architecture::arm::memory::ArmMemoryInterface;
use probe_rs::architecture::arm::sequences::ArmDebugSequence;
use probe_rs::architecture::arm::{
    ArmDebugInterface, ArmError, DapAccess, DapProbe, FullyQualifiedApAddress, SwdSequence, SwoAccess, SwoConfig,
};
use probe_rs::probe::list::{Lister, ProbeListItem, ProbeLister};
use probe_rs::probe::{
    DebugProbe, DebugProbeError, DebugProbeInfo, DebugProbeSelector, Probe, ProbeFactory, WireProtocol,
};

use super::{Handle, Target};
use crate::core::CoreError;

const NAME: &str = "emulated probe";

/// A lister that finds one probe, whose chip is the board's.
pub fn lister(board: Handle) -> Lister {
    Lister::with_lister(Box::new(OneProbe(board)))
}

#[derive(Debug)]
struct OneProbe(Handle);

impl ProbeLister for OneProbe {
    fn open(&self, _: &DebugProbeSelector) -> Result<Probe, DebugProbeError> {
        Ok(Probe::from_specific_probe(Box::new(EmulatedProbe(self.0.clone()))))
    }

    fn list_with_access(&self, _: Option<&DebugProbeSelector>) -> Vec<ProbeListItem> {
        // pid.codes' test numbers.
        let info = DebugProbeInfo::new(NAME, 0x1209, 0x0002, Some("1".into()), &NoFactory, None, false);
        vec![ProbeListItem::accessible(info)]
    }
}

/// Probes come from the lister.
#[derive(Debug)]
struct NoFactory;

impl fmt::Display for NoFactory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(NAME)
    }
}

impl ProbeFactory for NoFactory {
    fn open(&self, _: &DebugProbeSelector) -> Result<Box<dyn DebugProbe>, DebugProbeError> {
        Err(DebugProbeError::NotImplemented { function_name: "open" })
    }

    fn list_probes(&self) -> Vec<ProbeListItem> {
        Vec::new()
    }
}

#[derive(Debug)]
struct EmulatedProbe(Handle);

impl DebugProbe for EmulatedProbe {
    fn get_name(&self) -> &str {
        NAME
    }
    fn speed_khz(&self) -> u32 {
        4000
    }
    fn set_speed(&mut self, speed_khz: u32) -> Result<u32, DebugProbeError> {
        Ok(speed_khz)
    }
    fn attach(&mut self) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn detach(&mut self) -> Result<(), probe_rs::Error> {
        Ok(())
    }
    fn target_reset(&mut self) -> Result<(), DebugProbeError> {
        Err(DebugProbeError::NotImplemented { function_name: "target_reset" })
    }
    fn target_reset_assert(&mut self) -> Result<(), DebugProbeError> {
        self.target_reset()
    }
    fn target_reset_deassert(&mut self) -> Result<(), DebugProbeError> {
        self.target_reset()
    }
    fn select_protocol(&mut self, _: WireProtocol) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn active_protocol(&self) -> Option<WireProtocol> {
        Some(WireProtocol::Swd)
    }
    fn has_arm_interface(&self) -> bool {
        true
    }
    fn try_get_arm_debug_interface<'probe>(
        self: Box<Self>,
        _: Arc<dyn ArmDebugSequence>,
    ) -> Result<Box<dyn ArmDebugInterface + 'probe>, (Box<dyn DebugProbe>, ArmError)> {
        Ok(Box::new(Interface { probe: self, port: None }))
    }
    fn into_probe(self: Box<Self>) -> Box<dyn DebugProbe> {
        self
    }
}

/// Debug port and access port at once: memory is reached by its address.
#[derive(Debug)]
struct Interface {
    probe: Box<EmulatedProbe>,
    port: Option<DpAddress>,
}

impl ArmDebugInterface for Interface {
    fn reinitialize(&mut self) -> Result<(), ArmError> {
        Ok(())
    }
    fn access_ports(&mut self, dp: DpAddress) -> Result<BTreeSet<FullyQualifiedApAddress>, ArmError> {
        Ok(BTreeSet::from([FullyQualifiedApAddress::v1_with_dp(dp, 0)]))
    }
    fn close(self: Box<Self>) -> Probe {
        Probe::from_specific_probe(self.probe)
    }
    fn select_debug_port(&mut self, dp: DpAddress) -> Result<(), ArmError> {
        self.port = Some(dp);
        Ok(())
    }
    fn current_debug_port(&self) -> Option<DpAddress> {
        self.port
    }
    fn memory_interface(
        &mut self,
        access_port: &FullyQualifiedApAddress,
    ) -> Result<Box<dyn ArmMemoryInterface + '_>, ArmError> {
        let access_port = access_port.clone();
        Ok(Box::new(Memory { interface: self, access_port }))
    }
}

impl SwdSequence for Interface {
    fn swj_sequence(&mut self, _: u8, _: u64) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn swj_pins(&mut self, _: u32, _: u32, _: u32) -> Result<u32, DebugProbeError> {
        Err(DebugProbeError::NotImplemented { function_name: "swj_pins" })
    }
}

impl SwoAccess for Interface {
    fn enable_swo(&mut self, _: &SwoConfig) -> Result<(), ArmError> {
        Err(ArmError::NotImplemented("SWO"))
    }
    fn disable_swo(&mut self) -> Result<(), ArmError> {
        Err(ArmError::NotImplemented("SWO"))
    }
    fn read_swo_timeout(&mut self, _: Duration) -> Result<Vec<u8>, ArmError> {
        Err(ArmError::NotImplemented("SWO"))
    }
}

impl DapAccess for Interface {
    fn read_raw_dp_register(&mut self, _: DpAddress, _: DpRegisterAddress) -> Result<u32, ArmError> {
        Err(ArmError::NotImplemented("debug port registers"))
    }
    fn write_raw_dp_register(&mut self, _: DpAddress, _: DpRegisterAddress, _: u32) -> Result<(), ArmError> {
        Err(ArmError::NotImplemented("debug port registers"))
    }
    fn read_raw_ap_register(&mut self, _: &FullyQualifiedApAddress, _: u64) -> Result<u32, ArmError> {
        Err(ArmError::NotImplemented("access port registers"))
    }
    fn write_raw_ap_register(&mut self, _: &FullyQualifiedApAddress, _: u64, _: u32) -> Result<(), ArmError> {
        Err(ArmError::NotImplemented("access port registers"))
    }
    fn try_dap_probe(&self) -> Option<&dyn DapProbe> {
        None
    }
    fn try_dap_probe_mut(&mut self) -> Option<&mut dyn DapProbe> {
        None
    }
}

struct Memory<'a> {
    interface: &'a mut Interface,
    access_port: FullyQualifiedApAddress,
}

impl Memory<'_> {
    /// Does something with the chip; the emulator's failures are those of a probe.
    fn with<R: Send + 'static>(
        &self,
        deed: impl FnOnce(&mut Target) -> Result<R, CoreError> + Send + 'static,
    ) -> Result<R, ArmError> {
        let ended = || DebugProbeError::Other("the emulated board has ended".into());
        let done = self.interface.probe.0.with(deed).ok_or_else(ended)?;
        Ok(done.map_err(|error| DebugProbeError::Other(error.to_string()))?)
    }

    fn bytes(&self, address: u64, length: usize) -> Result<Vec<u8>, ArmError> {
        self.with(move |target| target.read(address as u32, length))
    }

    fn set_bytes(&self, address: u64, bytes: Vec<u8>) -> Result<(), ArmError> {
        self.with(move |target| target.write(address as u32, &bytes))
    }
}

impl ArmMemoryInterface for Memory<'_> {
    fn fully_qualified_address(&self) -> FullyQualifiedApAddress {
        self.access_port.clone()
    }
    fn base_address(&mut self) -> Result<u64, ArmError> {
        Err(ArmError::NotImplemented("ROM table"))
    }
    fn get_arm_debug_interface(&mut self) -> Result<&mut dyn ArmDebugInterface, DebugProbeError> {
        Ok(self.interface)
    }
    fn generic_status(&mut self) -> Result<CSW, ArmError> {
        Err(ArmError::NotImplemented("access port status"))
    }
}

impl MemoryInterface<ArmError> for Memory<'_> {
    fn supports_native_64bit_access(&mut self) -> bool {
        false
    }
    fn read_64(&mut self, address: u64, data: &mut [u64]) -> Result<(), ArmError> {
        let bytes = self.bytes(address, 8 * data.len())?;
        data.iter_mut().zip(bytes.as_chunks().0).for_each(|(word, bytes)| *word = u64::from_le_bytes(*bytes));
        Ok(())
    }
    fn read_32(&mut self, address: u64, data: &mut [u32]) -> Result<(), ArmError> {
        let bytes = self.bytes(address, 4 * data.len())?;
        data.iter_mut().zip(bytes.as_chunks().0).for_each(|(word, bytes)| *word = u32::from_le_bytes(*bytes));
        Ok(())
    }
    fn read_16(&mut self, address: u64, data: &mut [u16]) -> Result<(), ArmError> {
        let bytes = self.bytes(address, 2 * data.len())?;
        data.iter_mut().zip(bytes.as_chunks().0).for_each(|(word, bytes)| *word = u16::from_le_bytes(*bytes));
        Ok(())
    }
    fn read_8(&mut self, address: u64, data: &mut [u8]) -> Result<(), ArmError> {
        data.copy_from_slice(&self.bytes(address, data.len())?);
        Ok(())
    }
    fn write_64(&mut self, address: u64, data: &[u64]) -> Result<(), ArmError> {
        self.set_bytes(address, data.iter().flat_map(|w| w.to_le_bytes()).collect())
    }
    fn write_32(&mut self, address: u64, data: &[u32]) -> Result<(), ArmError> {
        self.set_bytes(address, data.iter().flat_map(|w| w.to_le_bytes()).collect())
    }
    fn write_16(&mut self, address: u64, data: &[u16]) -> Result<(), ArmError> {
        self.set_bytes(address, data.iter().flat_map(|w| w.to_le_bytes()).collect())
    }
    fn write_8(&mut self, address: u64, data: &[u8]) -> Result<(), ArmError> {
        self.set_bytes(address, data.to_vec())
    }
    fn supports_8bit_transfers(&self) -> Result<bool, ArmError> {
        Ok(true)
    }
    fn flush(&mut self) -> Result<(), ArmError> {
        Ok(())
    }
}
