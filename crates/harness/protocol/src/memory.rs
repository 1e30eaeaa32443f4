//! The memory of a process, as the system counts it.

/// Memory of a process in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// The most that was resident since its start: code, libraries and everything that was freed in between included.
    pub peak: u64,
    /// What is resident now.
    pub resident: u64,
}

impl Memory {
    /// That of a process, or of this one. `None` where the system has no `/proc`, or the process has exited.
    ///
    /// ```
    /// let memory = featherbench_protocol::Memory::of(None);
    /// assert!(memory.is_none_or(|memory| memory.peak >= memory.resident && memory.resident > 0));
    /// ```
    pub fn of(process: Option<u32>) -> Option<Self> {
        let process = process.map_or_else(|| "self".to_owned(), |id| id.to_string());
        Self::parse(&std::fs::read_to_string(format!("/proc/{process}/status")).ok()?)
    }

    /// That of a text in the form of `/proc/PID/status`.
    fn parse(status: &str) -> Option<Self> {
        let bytes = |key: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(key))?;
            let (number, unit) = line.trim().split_once(' ')?;
            (unit == "kB").then(|| number.parse::<u64>().ok())?.map(|kilobytes| kilobytes << 10)
        };
        let memory = Self { peak: bytes("VmHWM:")?, resident: bytes("VmRSS:")? };
        // The system counts in batches, and the two at different times: the peak may be a little behind.
        Some(Self { peak: memory.peak.max(memory.resident), ..memory })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_is_read_in_bytes() {
        let status = "Name:\tx\nVmPeak:\t  900 kB\nVmHWM:\t   20 kB\nVmRSS:\t   12 kB\n";
        assert_eq!(Memory::parse(status), Some(Memory { peak: 20 << 10, resident: 12 << 10 }));
        assert_eq!(Memory::parse("Name:\tx\nState:\tZ (zombie)\n"), None, "a process that has exited has none");
        assert_eq!(Memory::parse("VmHWM:\t20 MB\nVmRSS:\t12 kB\n"), None, "another unit is not taken for kilobytes");
    }

    #[test]
    fn memory_that_is_written_to_is_resident() {
        let Some(before) = Memory::of(None) else { return assert!(!std::path::Path::new("/proc/self/status").exists()) };
        let block = vec![1_u8; 64 << 20];
        let after = Memory::of(None).unwrap();
        assert!(std::hint::black_box(&block).len() == 64 << 20);
        // Other tests of this program run beside this one and free memory.
        assert!(after.peak >= before.peak && after.peak > 60 << 20, "{before:?} {after:?}");
    }
}
