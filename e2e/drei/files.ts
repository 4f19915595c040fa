import { readFileSync } from 'node:fs';
import { encodePly } from '@websplatter/core';
import { builtinScenes } from '@websplatter/scenes';
import type { ServedFiles } from '../server.ts';
import { splatSet } from '../three/splats.ts';

const text = (content: string): Uint8Array => new TextEncoder().encode(content);

/** Files that the trials load, as small as can be. */
export function trialFiles(): ServedFiles {
  const red = { color: [1, 0, 0], opacity: 0.99, scale: [0.35, 0.35, 0.35] } as const;
  return {
    'still-life-small.spz': readFileSync(builtinScenes[1].url),
    'ball.ply': encodePly(splatSet([red])),
    'sky.hdr': hdr(),
  };
}

/** A panorama of 4×2 pixels, one bright blue. */
function hdr(): Uint8Array {
  const header = text('#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n');
  const blue = [64, 96, 192, 129];
  return Uint8Array.from([...header, ...Array.from({ length: 8 }, () => blue).flat()]);
}
