//! Content hashes: the first 16 bytes of BLAKE3, in hexadecimal.

/// The hash of one text or file.
pub fn of(bytes: &[u8]) -> String {
    of_parts(&[bytes])
}

/// The hash of several parts; it depends on where each part ends.
pub fn of_parts(parts: &[&[u8]]) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().to_hex()[..32].to_owned()
}
