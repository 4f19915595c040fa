import { decodeHere } from '../loading/meshopt-on-page.ts';
import type { FormatReaders } from './read-format.ts';
import { ALL_READERS } from './readers.ts';

/** All formats, for threads that can fetch code. */
export const THREAD_READERS: FormatReaders = { ...ALL_READERS, decodeMeshopt: decodeHere };
