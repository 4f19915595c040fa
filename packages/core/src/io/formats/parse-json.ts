import { SplatFileError } from '../../data/errors.ts';
import { shown } from '../../data/printable.ts';
import { messageOf } from '../sources/byte-reader.ts';

/** `,`, `[` and `{`: each value but the first follows one, so they bound the number of values. */
const COMMA = 0x2c;
const BRACKET = 0x5b;
const BRACE = 0x7b;

/**
 * Parses the JSON of a file.
 *
 * @param mostValues most values in it; each takes up to 64 bytes of memory.
 * @throws SplatFileError 'too-large', 'bad-header'
 */
export function parseJson(bytes: Uint8Array, file: string, mostValues: number): unknown {
  let valueCount = 1;
  for (const byte of bytes) if (byte === COMMA || byte === BRACKET || byte === BRACE) valueCount++;
  if (valueCount > mostValues) {
    const message = `its JSON may have ${valueCount} values; at most ${mostValues} are read. Export it in larger parts.`;
    throw new SplatFileError('too-large', file, message);
  }
  try {
    return JSON.parse(new TextDecoder().decode(bytes));
  } catch (cause) {
    const isTooLong = cause instanceof RangeError;
    const message = isTooLong
      ? `its JSON of ${bytes.length} bytes is too long for this browser. Export it in parts.`
      : `its JSON cannot be read (${shown(messageOf(cause))}). Download or export it again.`;
    throw new SplatFileError(isTooLong ? 'too-large' : 'bad-header', file, message, {}, { cause });
  }
}
