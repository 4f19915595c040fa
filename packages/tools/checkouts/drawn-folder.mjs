import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const INDEX = 'drawn.json';

/** A folder that takes what one checkout draws: an index, and a file of raw float32 per image. */
export class DrawnFolder {
  #folder;
  #outputs = [];
  #notes = [];

  constructor(folder) {
    mkdirSync(folder, { recursive: true });
    this.#folder = folder;
  }

  /** @param values Float32Array, row by row from the top, all channels of a pixel side by side. */
  image(name, { widthPx, heightPx, values }) {
    const file = `${name.replaceAll('/', '.')}.f32`;
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    writeFileSync(join(this.#folder, file), bytes);
    const sha256 = createHash('sha256').update(bytes).digest('hex');
    this.#add({ name, widthPx, heightPx, file, sha256 });
  }

  /** Anything else that has to be the same: what JSON can hold. */
  value(name, value) {
    this.#add({ name, value });
  }

  skipped(name, reason) {
    this.#add({ name, skipped: reason });
  }

  failed(name, message) {
    this.#add({ name, failed: message });
  }

  /** What is worth knowing and may differ. */
  note(name, value) {
    this.#notes.push({ name, value });
  }

  /** Call last: without an index the folder counts as unfinished. */
  close(facts) {
    const index = { ...facts, outputs: this.#outputs, notes: this.#notes };
    writeFileSync(join(this.#folder, INDEX), JSON.stringify(index, null, 1));
  }

  #add(output) {
    if (this.#outputs.some(({ name }) => name === output.name))
      throw new RangeError(`There are two outputs named ${output.name}: one would hide the other.`);
    this.#outputs.push(output);
  }
}

/** What `DrawnFolder` wrote; `outputs` as `compareDrawn` takes them. */
export function readDrawnFolder(folder) {
  const { outputs, notes, ...facts } = JSON.parse(readFileSync(join(folder, INDEX), 'utf8'));
  const read = ({ name, file, ...output }) => {
    if (!file) return [name, output];
    const bytes = readFileSync(join(folder, file));
    const values = new Float32Array(
      bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength),
    );
    return [name, { ...output, values }];
  };
  return { ...facts, outputs: new Map(outputs.map(read)), notes };
}
