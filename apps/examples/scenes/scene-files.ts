import { encodePly } from '@websplatter/core';
import { stillLife } from '@websplatter/scenes';
import type { Plugin } from 'vite';
import { ring } from './ring.ts';

/** The files that the examples show. Made by code, so that the repository needs no captures. */
const SCENES: Readonly<Record<string, () => Uint8Array>> = {
  'still-life.ply': () => encodePly(stillLife({ splats: 60_000, shDegree: 1 })),
  'ring.ply': () => encodePly(ring()),
};

/** Serves the scenes as files beside the app, and builds them into it. */
export function sceneFiles(): Plugin {
  return {
    name: 'scene-files',
    configureServer({ middlewares }) {
      for (const [fileName, make] of Object.entries(SCENES)) {
        middlewares.use(`/${fileName}`, (_request, response) => {
          response.setHeader('content-type', 'application/octet-stream');
          response.end(make());
        });
      }
    },
    generateBundle() {
      for (const [fileName, make] of Object.entries(SCENES))
        this.emitFile({ type: 'asset', fileName, source: make() });
    },
  };
}
