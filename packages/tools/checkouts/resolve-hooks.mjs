import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

let checkout;
let dawn;

/** @param options.checkout folder whose packages are imported; `dawn` the dawn.node to use, or null for npm's. */
export function initialize(options) {
  ({ checkout, dawn } = options);
}

/**
 * Finds `@websplatter/…` in the dist folders of one checkout. Links in node_modules are not followed: copies of dist without
 * node_modules can be run, and a copy never runs the code of the checkout that it was made from.
 */
export function resolve(specifier, context, nextResolve) {
  const [, name, entry = 'index'] = /^@websplatter\/([^/]+)(?:\/(.+))?$/.exec(specifier) ?? [];
  if (name) {
    const url = pathToFileURL(join(checkout, 'packages', name, 'dist', `${entry}.js`)).href;
    return { url, shortCircuit: true };
  }
  if (specifier === 'webgpu' && dawn !== null) return { url: dawnModule(dawn), shortCircuit: true };
  return nextResolve(specifier, context);
}

/** What npm's `webgpu` exports, from the file itself. */
function dawnModule(file) {
  const code = `import { createRequire } from 'node:module';
    export const { create, globals } = createRequire('file:///')(${JSON.stringify(file)});`;
  return `data:text/javascript,${encodeURIComponent(code)}`;
}
