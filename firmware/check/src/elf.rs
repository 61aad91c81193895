//! What an image is made of: its symbols, and which of them the fuser's part can reach.

use std::{collections::BTreeMap, error::Error};

use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget, SymbolKind, read::elf::ElfFile32};

/// The function that all of the fuser's part hangs from.
const ROOT: &str = "fuse_reading";

/// A function, or a table of constants.
struct Part {
    name: String,
    size: u64,
}

/// What an image is made of.
pub struct Image {
    /// Bytes of instructions in the whole image.
    pub instructions: u64,
    /// Bytes of variables in the whole image.
    pub variables: u64,
    /// Bytes of all that the fuser's part can reach.
    pub fuser_code: u64,
    /// Its functions and tables, the largest first, with their sizes.
    pub fuser_parts: Vec<(String, u64)>,
    /// Every symbol of the image.
    pub symbols: Vec<String>,
}

impl Image {
    /// Reads an image that was linked with `--emit-relocs`.
    pub fn read(bytes: &[u8]) -> Result<Self, Box<dyn Error>> {
        let file = ElfFile32::<object::Endianness>::parse(bytes)?;
        let parts = parts(&file);
        let mut reached: BTreeMap<u64, &Part> = BTreeMap::new();
        let root = parts.iter().find(|(_, part)| part.name == ROOT).ok_or("the image has no `fuse_reading`")?;
        let references = references(&file);
        if references.is_empty() {
            return Err("the image was linked without --emit-relocs".into());
        }
        let mut open = vec![*root.0];
        while let Some(start) = open.pop() {
            let Some(part) = parts.get(&start) else { continue };
            if reached.insert(start, part).is_none() {
                let end = start + part.size;
                open.extend(references.range(start..end).flat_map(|(_, targets)| targets).filter_map(|&target| {
                    let (&found, part) = parts.range(..=target).next_back()?;
                    (target < found + part.size).then_some(found)
                }));
            }
        }
        let mut fuser_parts: Vec<_> = reached.values().map(|part| (part.name.clone(), part.size)).collect();
        fuser_parts.sort_by_key(|(name, size)| (u64::MAX - size, name.clone()));
        Ok(Self {
            instructions: file.section_by_name(".text").map_or(0, |section| section.size()),
            variables: [".data", ".bss"].iter().filter_map(|name| Some(file.section_by_name(name)?.size())).sum(),
            fuser_code: fuser_parts.iter().map(|(_, size)| size).sum(),
            fuser_parts,
            symbols: file.symbols().filter_map(|symbol| symbol.name().ok().map(str::to_owned)).collect(),
        })
    }
}

/// Functions and constants by their addresses. The lowest bit of a function's says Thumb.
fn parts(file: &ElfFile32<'_>) -> BTreeMap<u64, Part> {
    let constant =
        |index| file.section_by_index(index).is_ok_and(|section| matches!(section.name(), Ok(".text" | ".rodata")));
    file.symbols()
        .filter(|symbol| matches!(symbol.kind(), SymbolKind::Text | SymbolKind::Data) && symbol.size() > 0)
        .filter(|symbol| symbol.section_index().is_some_and(constant))
        .map(|symbol| {
            let name = symbol.name().unwrap_or_default().to_owned();
            (symbol.address() & !u64::from(symbol.kind() == SymbolKind::Text), Part { name, size: symbol.size() })
        })
        .collect()
}

/// From where in the image to where: the relocations that the linker has left in.
fn references(file: &ElfFile32<'_>) -> BTreeMap<u64, Vec<u64>> {
    let mut references: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
    for section in file.sections() {
        for (place, relocation) in section.relocations() {
            let RelocationTarget::Symbol(index) = relocation.target() else { continue };
            let Ok(symbol) = file.symbol_by_index(index) else { continue };
            let target = match symbol.kind() {
                SymbolKind::Text => symbol.address() & !1,
                // A table without a name of its own: the word at the place is its address.
                SymbolKind::Section => word(&section, place).unwrap_or_else(|| symbol.address()),
                _ => symbol.address(),
            };
            references.entry(place).or_default().push(target);
        }
    }
    references
}

fn word<'file>(section: &impl ObjectSection<'file>, place: u64) -> Option<u64> {
    let bytes = section.data_range(place, 4).ok()??;
    Some(u64::from(u32::from_le_bytes(bytes.try_into().ok()?)))
}

/// Whether a symbol is a routine of software double precision.
pub fn is_soft_double(symbol: &str) -> bool {
    const ARM: [&str; 7] =
        ["__aeabi_d", "__aeabi_cd", "__aeabi_f2d", "__aeabi_i2d", "__aeabi_ui2d", "__aeabi_l2d", "__aeabi_ul2d"];
    // __muldf3, __floatsidf, __fixdfsi, __extendsfdf2, __truncdfsf2, __ledf2 …; libm's have no such names.
    let gnu = symbol.rsplit_once("__").is_some_and(|(_, word)| word.contains("df"));
    gnu || ARM.iter().any(|name| symbol.starts_with(name))
}

/// Whether a symbol belongs to an allocator.
pub fn is_heap(symbol: &str) -> bool {
    ["__rust_alloc", "__rust_realloc", "__rdl_", "__rg_", "malloc", "_sbrk", "5alloc5alloc"]
        .iter()
        .any(|name| symbol.contains(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn double_precision_is_told_from_single() {
        for double in [
            "__aeabi_dmul",
            "__aeabi_f2d",
            "__muldf3",
            "__truncdfsf2",
            "_RNvNtNtCsX17compiler_builtins5float3add8___adddf3",
        ] {
            assert!(is_soft_double(double), "{double}");
        }
        for other in [
            "_RNvNtNtCsX17compiler_builtins5float3add8___addsf3",
            "__aeabi_fmul",
            "__mulsf3",
            "__aeabi_memcpy4",
            "__divsi3",
            "__sidata",
            "fuse_reading",
        ] {
            assert!(!is_soft_double(other), "{other}");
        }
    }

    #[test]
    fn allocators_are_told_from_the_rest() {
        assert!(is_heap("__rust_alloc") && is_heap("malloc"));
        assert!(!is_heap("__sheap") && !is_heap("fuse_reading"));
    }
}
