import { readdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { deflateSync } from 'node:zlib';
import { encodePly } from '@websplatter/core';
import { stillLife } from '@websplatter/scenes';
import type { ServedFiles } from '../server.ts';
import { splatSet } from '../three/splats.ts';

const text = (content: string): Uint8Array => new TextEncoder().encode(content);

/** What the trials load: all made here, as small as it can be. */
export function trialFiles(): ServedFiles {
  const red = { color: [1, 0, 0], opacity: 0.99, scale: [0.35, 0.35, 0.35] } as const;
  return {
    'still-life.ply': encodePly(stillLife({ splats: 5000, shDegree: 0 })),
    'ball.ply': encodePly(splatSet([red])),
    'font.ttf': iconFont(),
    'green.png': png(8, 8, [64, 192, 96]),
    'sky.hdr': hdr(),
    'triangle.glb': glb(),
    'square.svg': text(
      '<svg xmlns="http://www.w3.org/2000/svg"><path fill="#ffffff" d="M0 0H100V100H0Z"/></svg>',
    ),
    'typeface.json': text(
      JSON.stringify({
        resolution: 1000,
        familyName: 'Square',
        boundingBox: { xMin: 0, yMin: 0, xMax: 800, yMax: 800 },
        underlineThickness: 0,
        glyphs: { A: { ha: 800, o: 'm 0 0 l 0 800 l 800 800 l 800 0' } },
      }),
    ),
  };
}

/** An image of one colour. */
function png(widthPx: number, heightPx: number, color: readonly number[]): Uint8Array {
  const rows = Array.from({ length: heightPx }, () => [
    0,
    ...Array.from({ length: widthPx }, () => color).flat(),
  ]);
  const header = Buffer.alloc(13);
  header.writeUInt32BE(widthPx, 0);
  header.writeUInt32BE(heightPx, 4);
  header.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
    pngChunk('IHDR', header),
    pngChunk('IDAT', deflateSync(Buffer.from(rows.flat()))),
    pngChunk('IEND', Buffer.alloc(0)),
  ]);
}

function pngChunk(type: string, data: Buffer): Buffer {
  const body = Buffer.concat([Buffer.from(type, 'latin1'), data]);
  const chunk = Buffer.alloc(body.length + 8);
  chunk.writeUInt32BE(data.length, 0);
  body.copy(chunk, 4);
  chunk.writeUInt32BE(crc32(body), body.length + 4);
  return chunk;
}

function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

/** A panorama of 4×2 pixels, one bright blue. */
function hdr(): Uint8Array {
  const header = text('#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n');
  const blue = [64, 96, 192, 129];
  return Uint8Array.from([...header, ...Array.from({ length: 8 }, () => blue).flat()]);
}

/** A glTF file of one triangle, 2 units wide. */
function glb(): Uint8Array {
  const positions = Buffer.from(Float32Array.from([-1, -1, 0, 1, -1, 0, 0, 1, 0]).buffer);
  const json = JSON.stringify({
    asset: { version: '2.0' },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [-1, -1, 0], max: [1, 1, 0] },
    ],
    bufferViews: [{ buffer: 0, byteLength: positions.length }],
    buffers: [{ byteLength: positions.length }],
  });
  const padded = Buffer.from(json.padEnd(4 * Math.ceil(json.length / 4)));
  const words = (...values: number[]) => Buffer.from(Uint32Array.from(values).buffer);
  return Buffer.concat([
    words(0x46546c67, 2, 28 + padded.length + positions.length),
    words(padded.length, 0x4e4f534a),
    padded,
    words(positions.length, 0x004e4942),
    positions,
  ]);
}

/** Playwright's own font of icons, of which no letter fills the rectangle that it is drawn in. */
function iconFont(): Uint8Array {
  const folder = join(
    dirname(createRequire(import.meta.url).resolve('playwright-core/package.json')),
    'lib/vite/traceViewer',
  );
  const file = readdirSync(folder).find((name) => /^codicon.*\.ttf$/.test(name));
  if (!file)
    throw new Error(
      `playwright-core has no font in ${folder} any more: serve another one to the trial of Text.`,
    );
  return readFileSync(join(folder, file));
}
