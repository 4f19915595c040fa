import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseSync, Visitor } from 'oxc-parser';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));

/** Code of pages that is published in chunks. */
const CHUNKED =
  /^(?:packages\/(?:core|three|react)|apps\/viewer)\/src\/(?!.*\.(?:test|d|fixture)\.|testing\/).*\.tsx?$/;

/** Functions that report code which cannot be fetched: by a typed error, a notice, or in its place. */
const REPORTERS = new Set(['fetched', 'withCode', 'lazyCode', 'lazyComponent']);

/** Who reports lost code of modules that others await. */
const EXCEPTIONS: Readonly<Record<string, string>> = {
  'apps/viewer/src/accuracy/accuracy-settings.tsx': '`useDetailDb` catches it',
  'apps/viewer/src/accuracy/measure-presets.ts': '`Measurement.run` shows failures in the panel',
  'apps/viewer/src/app/picture.tsx': '`lazyComponent` and `lazyCode` take it',
  'apps/viewer/src/effects/effect-costs.ts': '`Measurement.run` shows failures in the panel',
  'apps/viewer/src/engine/open/catalogue.ts': 'the load or the worker that needs the case fails with it',
  'apps/viewer/src/engine/open/load-scene.ts': 'the load fails with it, which `Scenes` reports',
  'apps/viewer/src/engine/open/read-again.ts': 'the task of the worker fails with it',
  'apps/viewer/src/engine/open/scenes.ts': '`#lookFinder` is part of a load, whose failure is reported',
  'apps/viewer/src/engine/viewer.ts': 'without the code, as without storage, no files are remembered',
  'apps/viewer/src/main.ts': '`showPage` shows a page that says so',
  'apps/viewer/src/scene/clouds-panel.tsx': '`look` drops it, and says why',
  'apps/viewer/src/scene/scene.worker.ts': 'the task fails with it, and its caller says so',
  'apps/viewer/src/share/videos.ts': 'filming fails with it',
  'apps/viewer/src/view-modes/follow-view-mode.ts': '`follow` catches it',
  'apps/viewer/src/view-modes/show-map.ts': '`drawAtRest` calls `onFail`',
  'packages/core/src/clouds/ingest/lazy-ingest.ts': '`begin` fetches the same code, and reports it',
  'packages/core/src/clouds/stream/load-streamed.ts': '`loadBy` awaits it by `fetched`',
  'packages/core/src/create-engine.ts': '`SplatEngine.create` awaits it by `fetched`',
  'packages/core/src/engine.ts': '`ViewDetail` warns on the console, and draws in full',
  'packages/core/src/io/loading/load-splats.ts': '`makerOf` awaits it by `fetched`',
  'packages/core/src/io/loading/scene-workers.ts': 'without workers, the calling thread reads',
  'packages/core/src/stages/compose/compose.ts': '`linkShader` awaits it by `fetched`',
  'packages/core/src/stages/levels.ts': '`linkShader` awaits it by `fetched`',
  'packages/core/src/stages/tiles/tiles.ts': '`linkShader` awaits it by `fetched`',
  'packages/core/src/stages/wide-keys/wide-keys.ts': '`linkShader` awaits it by `fetched`',
  'packages/react/src/use-splat-collider.ts': 'the hook returns the error',
  'packages/react/src/use-splat-sequence.ts': '`onError` or the console gets it',
  'packages/three/src/cloud/splat-data.ts':
    'callers of `rowsIn`, `prepareRays` and `acquire` get it; rays call `tellOfRays`',
  'packages/three/src/layer/splat-layer.ts': '`#load` reports it',
};

/** Imports that a module awaits without a report of lost code, as `line: specifier`. */
function unreportedImports(path: string, text: string): string[] {
  if (!text.includes('import(')) return [];
  const reported: { readonly start: number; readonly end: number }[] = [];
  const found: string[] = [];
  // Parents are visited before their children.
  new Visitor({
    TryStatement({ block, handler }) {
      if (handler) reported.push(block);
    },
    CallExpression({ callee, arguments: given }) {
      if (callee.type === 'Identifier' && REPORTERS.has(callee.name)) reported.push(...given);
      if (callee.type !== 'MemberExpression' || callee.property.type !== 'Identifier') return;
      const { name } = callee.property;
      if (name === 'catch' || (name === 'then' && given.length > 1)) reported.push(callee.object);
    },
    ImportExpression({ start, end, source }) {
      if (reported.some((each) => each.start <= start && end <= each.end)) return;
      found.push(`${text.slice(0, start).split('\n').length}: ${text.slice(source.start, source.end)}`);
    },
  }).visit(parseSync(path, text).program);
  return found;
}

/**
 * @fault Pages and packages: code that is fetched on demand is lost
 * @consequence every import on demand ends in a report, whichever chunk is lost
 */
test('code that cannot be fetched is reported', () => {
  const paths = repositoryFiles(root).filter((path) => CHUNKED.test(path));
  expect(paths.length).toBeGreaterThan(500);
  const found = paths.flatMap((path) =>
    unreportedImports(path, readFileSync(join(root, path), 'utf8')).map((each) => ({ path, each })),
  );
  const unreported = found.filter(({ path }) => !Object.hasOwn(EXCEPTIONS, path));
  expect(unreported.map(({ path, each }) => `${path}:${each}`)).toEqual([]);
  const needless = Object.keys(EXCEPTIONS).filter((path) => !found.some((each) => each.path === path));
  expect(needless).toEqual([]);
});

test('the rule on lost code finds imports without a report, and no others', () => {
  const text = `const a = await import('./a.ts');
const b = () => import('./b.ts').then(use);
const c = await fetched('c', import('./c.ts'));
import('./d.ts').then(use, report);
import('./e.ts').catch(report);
try { await import('./f.ts'); } catch (error) { report(error); }
void withCode(store, () => import('./g.ts'), use);
const h: typeof import('./h.ts') | null = null;`;
  expect(unreportedImports('a.ts', text)).toEqual(["1: './a.ts'", "2: './b.ts'"]);
});
