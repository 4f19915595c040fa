// Records of zip archives (PKWARE's APPNOTE 6.3): signatures, lengths, byte offsets of their fields.

/** Precedes each file. */
export const LOCAL_HEADER = {
  signature: 0x04034b50,
  bytes: 30,
  version: 4,
  flags: 6,
  date: 12,
  crc: 14,
  packedBytes: 18,
  unpackedBytes: 22,
  nameLength: 26,
  extraLength: 28,
} as const;

export const DIRECTORY_ENTRY = {
  signature: 0x02014b50,
  bytes: 46,
  writerVersion: 4,
  version: 6,
  flags: 8,
  method: 10,
  date: 14,
  crc: 16,
  packedBytes: 20,
  unpackedBytes: 24,
  nameLength: 28,
  extraLength: 30,
  commentLength: 32,
  localHeader: 42,
} as const;

export const DIRECTORY_END = {
  signature: 0x06054b50,
  bytes: 22,
  disk: 4,
  directoryDisk: 6,
  entriesHere: 8,
  entries: 10,
  directoryBytes: 12,
  directory: 16,
  commentLength: 20,
} as const;

/** End record with 64-bit numbers. */
export const ZIP64_END = {
  signature: 0x06064b50,
  bytes: 56,
  disk: 16,
  directoryDisk: 20,
  entriesHere: 24,
  entries: 32,
  directoryBytes: 40,
  directory: 48,
} as const;

/** Precedes `DIRECTORY_END` and gives the offset of `ZIP64_END`. */
export const ZIP64_LOCATOR = {
  signature: 0x07064b50,
  bytes: 20,
  end: 8,
} as const;

/** Id of the extra field with an entry's 64-bit numbers. */
export const ZIP64_EXTRA_ID = 1;

/** Compression method of uncompressed files. */
export const STORED = 0;
