/**
 * Writing splats as files (`@websplatter/core/write`), apart from the engine: a page that only shows splats does not download it.
 */
export type { WriteOptions } from './io/formats/write-format.ts';
export { WRITABLE_FORMATS, type WritableFormat, writableByName, writeSplats } from './io/formats/writers.ts';
