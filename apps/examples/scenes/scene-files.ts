import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';
import { type Plugin, runnerImport } from 'vite';

/** Number of files in the sequence. */
const WAVE_FRAMES = 8;

const MADE_FILES = [
  'ring.ply',
  'column.glb',
  'bird.frames',
  'knot.ply',
  'terrain.ply',
  'meadow.ply',
  'figure.ply',
  'figures.ply',
  ...Array.from({ length: WAVE_FRAMES }, (_, frame) => `wave-${frame}.ply`),
];

/** The examples' scene files, by name. */
const SCENE_FILES: Readonly<Record<string, () => Promise<Uint8Array>>> = {
  'still-life.sog': () => builtinFile('still-life.sog'),
  'still-life-small.spz': () => builtinFile('still-life-small.spz'),
  ...Object.fromEntries(MADE_FILES.map((name) => [name, () => madeFile(name)])),
};

function builtinFile(name: string): Promise<Uint8Array> {
  return readFile(createRequire(import.meta.url).resolve(`@websplatter/scenes/files/${name}`));
}

/**
 * Generates the file from the packages' sources, as the page does: the packages need not be built.
 */
async function madeFile(name: string): Promise<Uint8Array> {
  const path = fileURLToPath(new URL('./made-scenes.ts', import.meta.url));
  const resolve = { conditions: ['@websplatter/source'], noExternal: [/^@websplatter\//] };
  const { module } = await runnerImport<typeof import('./made-scenes.ts')>(path, {
    configFile: false,
    logLevel: 'error',
    environments: { inline: { resolve } },
  });
  return module.madeScene(name, WAVE_FRAMES);
}

/** Vite plugin that serves the scenes as files beside the app, and emits them in builds. */
export function sceneFiles(): Plugin {
  return {
    name: 'scene-files',
    configureServer({ middlewares }) {
      for (const [name, read] of Object.entries(SCENE_FILES)) {
        middlewares.use(`/${name}`, async (_request, response, next) => {
          try {
            const bytes = await read();
            response.setHeader('content-type', 'application/octet-stream');
            response.end(bytes);
          } catch (error) {
            next(error);
          }
        });
      }
    },
    async generateBundle() {
      for (const [name, read] of Object.entries(SCENE_FILES))
        this.emitFile({ type: 'asset', fileName: name, source: await read() });
    },
  };
}
