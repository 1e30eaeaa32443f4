//! Messages: a line of JSON, followed by the blocks of doubles that it announces.
//!
//! `oracles/PROTOCOL.md` defines them. The outcomes of a run are a file of such messages.

use serde_json::{Map, Value, json};
use std::io::{self, BufRead, Read, Write};
use thiserror::Error;

/// A named array of doubles.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// What it contains.
    pub name: String,
    /// Its extents; the numbers are in row-major order.
    pub shape: Vec<usize>,
    /// The numbers.
    pub data: Vec<f64>,
}

/// A JSON object with blocks after it.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Message {
    /// The object, without its `blocks`.
    pub header: Map<String, Value>,
    /// The blocks, in order.
    pub blocks: Vec<Block>,
}

/// Why a message could not be read.
#[derive(Debug, Error)]
pub enum MessageError {
    /// The stream failed.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The stream ended inside a message.
    #[error("the stream ends in the middle of a message")]
    Truncated,
    /// The header is not what the protocol says.
    #[error("bad message header: {0}")]
    Header(String),
}

/// The longest header line, and the largest sum of block lengths in numbers: far more than any robot needs, far less than the memory.
const HEADER_LIMIT: u64 = 256 << 20;
const BLOCK_LIMIT: usize = 1 << 28;

impl Block {
    /// A block of rows.
    pub fn new(name: &str, shape: &[usize], data: &[f64]) -> Self {
        Self { name: name.to_owned(), shape: shape.to_vec(), data: data.to_vec() }
    }
}

impl Message {
    /// A message whose header is the given object.
    pub fn new(header: Value, blocks: Vec<Block>) -> Self {
        let header = if let Value::Object(header) = header { header } else { Map::new() };
        Self { header, blocks }
    }

    /// A text of the header, or "" when there is none.
    pub fn text(&self, key: &str) -> &str {
        self.header.get(key).and_then(Value::as_str).unwrap_or("")
    }

    /// The block of this name.
    pub fn block(&self, name: &str) -> Option<&Block> {
        self.blocks.iter().find(|block| block.name == name)
    }

    /// The message as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut header = self.header.clone();
        if !self.blocks.is_empty() {
            let blocks = self.blocks.iter().map(|block| json!({"name": block.name, "shape": block.shape})).collect();
            header.insert("blocks".into(), Value::Array(blocks));
        }
        let mut bytes = Value::Object(header).to_string().into_bytes();
        bytes.push(b'\n');
        for block in &self.blocks {
            let begin = bytes.len();
            bytes.resize(begin + 8 * block.data.len(), 0);
            bytes[begin..].as_chunks_mut().0.iter_mut().zip(&block.data).for_each(|(bytes, x)| *bytes = x.to_le_bytes());
        }
        bytes
    }

    /// Writes the message.
    ///
    /// # Errors
    /// When the stream does.
    pub fn write(&self, stream: &mut impl Write) -> io::Result<()> {
        stream.write_all(&self.to_bytes())?;
        stream.flush()
    }

    /// Reads one message; `None` at the end of the stream.
    ///
    /// # Errors
    /// [`MessageError`]. Memory is allocated only for data that arrives, whatever a wrong header announces.
    pub fn read(stream: &mut impl BufRead) -> Result<Option<Self>, MessageError> {
        let mut line = Vec::new();
        stream.by_ref().take(HEADER_LIMIT).read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(None);
        }
        if line.pop() != Some(b'\n') {
            return Err(MessageError::Truncated);
        }
        let mut header: Map<String, Value> = serde_json::from_slice(&line).map_err(|error| MessageError::Header(error.to_string()))?;
        let mut blocks = Vec::new();
        let mut total = 0_usize;
        for announced in header.remove("blocks").as_ref().and_then(Value::as_array).into_iter().flatten() {
            let (name, shape, length) = announced_block(announced)?;
            total = total.saturating_add(length);
            if total > BLOCK_LIMIT {
                return Err(MessageError::Header(format!("block '{name}' is too long")));
            }
            let mut bytes = Vec::new();
            stream.by_ref().take(8 * length as u64).read_to_end(&mut bytes)?;
            if bytes.len() != 8 * length {
                return Err(MessageError::Truncated);
            }
            let data = bytes.chunks_exact(8).map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])).collect();
            blocks.push(Block { name, shape, data });
        }
        Ok(Some(Self { header, blocks }))
    }
}

fn announced_block(announced: &Value) -> Result<(String, Vec<usize>, usize), MessageError> {
    let complaint = || MessageError::Header(format!("a block must be {{name, shape}}, not {announced}"));
    let name = announced["name"].as_str().ok_or_else(complaint)?.to_owned();
    let extents = announced["shape"].as_array().ok_or_else(complaint)?;
    let shape: Vec<usize> =
        extents.iter().map(|extent| extent.as_u64().and_then(|x| usize::try_from(x).ok())).collect::<Option<_>>().ok_or_else(complaint)?;
    let length = shape.iter().try_fold(1_usize, |product, &extent| product.checked_mul(extent)).ok_or_else(complaint)?;
    Ok((name, shape, length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    #[test]
    fn round_trip_keeps_every_bit() {
        let data = [0.1, -0.0, f64::MIN_POSITIVE / 3.0, f64::NAN, f64::INFINITY, 1e308];
        let message = Message::new(json!({"op": "x", "π": 0.1}), vec![Block::new("a", &[2, 3], &data), Block::new("b", &[0], &[])]);
        let bytes = message.to_bytes();
        let read = Message::read(&mut bytes.as_slice()).unwrap().unwrap();
        assert_eq!(read.header, message.header);
        let bits = |message: &Message| message.blocks.iter().flat_map(|b| b.data.iter().map(|x| x.to_bits())).collect::<Vec<_>>();
        assert_eq!(bits(&read), bits(&message));
        for cut in 1..bytes.len() {
            assert!(matches!(Message::read(&mut &bytes[..cut]), Err(MessageError::Truncated)), "cut at {cut}");
        }
    }

    #[test]
    fn a_lying_header_is_refused_before_it_costs_memory() {
        for shape in ["[1e30]", "[-1]", "[18446744073709551615,8]", "[999999999999]", "\"x\""] {
            let line = format!("{{\"blocks\":[{{\"name\":\"a\",\"shape\":{shape}}}]}}\n");
            assert!(matches!(Message::read(&mut line.as_bytes()), Err(MessageError::Header(_))), "{shape}");
        }
        let short = b"{\"blocks\":[{\"name\":\"a\",\"shape\":[100000000]}]}\n12345678";
        assert!(matches!(Message::read(&mut short.as_slice()), Err(MessageError::Truncated)));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

        #[test]
        fn reading_anything_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = Message::read(&mut bytes.as_slice());
        }
    }
}
