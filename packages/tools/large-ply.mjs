// `node packages/tools/large-ply.mjs N`: writes a PLY of N splats of degree 3 to standard output,
// for measurements of scenes larger than memory. The scene is a grid of places with the same
// synthetic splats, each in another order, size and colour. Only one place is in memory.
import { once } from 'node:events';
import { fail } from './setup.mjs';

/** Splats per place; a prime, so that any step through them visits each once. */
const PLACE_SPLATS = 199_999;
/** Distance between places, metres: grounds touch and domes overlap. */
const SPACING_M = 24;
const VALUES = { position: 0, colorDc: 3, logScale: 52, count: 59 };
const END_OF_HEADER = 'end_header\n';

const splats = Number(process.argv[2]);
if (!(Number.isInteger(splats) && splats > 0)) fail('large-ply: give the number of splats');
const { build } = await import('./build.mjs');
// Standard output is reserved for the PLY.
console.log = console.error;
await build().catch((error) => fail(error.message));
const { syntheticPly } = await import('../scenes/dist/index.js');

const chunks = [];
for await (const chunk of syntheticPly({ splats: PLACE_SPLATS, shDegree: 3 })) chunks.push(chunk);
const ply = Buffer.concat(chunks);
const start = ply.indexOf(END_OF_HEADER) + END_OF_HEADER.length;
const place = new Float32Array(new Uint8Array(ply.subarray(start)).buffer);
const header = ply.toString('latin1', 0, start).replace(`vertex ${PLACE_SPLATS}`, `vertex ${splats}`);
await put(Buffer.from(header));
const side = Math.ceil(Math.sqrt(splats / PLACE_SPLATS));
for (let i = 0; i * PLACE_SPLATS < splats; i++)
  await put(placed(i, Math.min(PLACE_SPLATS, splats - i * PLACE_SPLATS)));

/** The rows of place `i`. */
function placed(i, count) {
  const rows = new Float32Array(count * VALUES.count);
  const [x, z] = [SPACING_M * (i % side), SPACING_M * Math.floor(i / side)];
  const size = 1 + 0.2 * Math.sin(i);
  const step = 1 + ((7919 * i) % (PLACE_SPLATS - 1));
  for (let row = 0, from = 0; row < count; row++, from = (from + step) % PLACE_SPLATS) {
    const at = row * VALUES.count;
    for (let k = 0; k < VALUES.count; k++) rows[at + k] = place[from * VALUES.count + k];
    for (let k = 0; k < 3; k++) {
      rows[at + VALUES.position + k] *= size;
      rows[at + VALUES.logScale + k] += Math.log(size);
      rows[at + VALUES.colorDc + k] += 0.3 * Math.cos(i + k);
    }
    rows[at + VALUES.position] += x;
    rows[at + VALUES.position + 2] += z;
  }
  return Buffer.from(rows.buffer);
}

async function put(bytes) {
  if (!process.stdout.write(bytes)) await once(process.stdout, 'drain');
}
