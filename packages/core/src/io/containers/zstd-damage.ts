/** A fault of Zstandard data, in words that follow "it cannot be unpacked:". */
export class ZstdDamage extends Error {}
