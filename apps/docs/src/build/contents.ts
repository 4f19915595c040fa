import { readdirSync, readFileSync } from 'node:fs';
import { DocsError, headingsOf } from './markdown.ts';

// Contents of the site, in order: the sidebar, and the repository's documents that are whole pages.

const root = new URL('../../../../', import.meta.url);

/** Records of decisions, `docs/decisions/NNN-NAME.md`, which begin with `# NNN: TITLE`. */
const DECISIONS = readdirSync(new URL('docs/decisions', root))
  .sort()
  .map((file) => {
    const path = `docs/decisions/${file}`;
    const heading = headingsOf(readFileSync(new URL(path, root), 'utf8'))[0]?.text;
    const [, number, title] = /^(\d{3}): (.+)$/.exec(heading ?? '') ?? [];
    if (!title || !file.startsWith(`${number}-`))
      throw new DocsError(
        `${path} begins with “${heading}”, not with its number and a title, as in “001: Title”.`,
      );
    return { path, page: `contribute/decisions/${file}`, text: `${number} ${title}` };
  });

/**
 * Documents of the repository that are whole pages, by path. Links to a document lead to its page.
 */
export const REPOSITORY_PAGES: Readonly<Record<string, string>> = {
  'ARCHITECTURE.md': 'contribute/architecture.md',
  'CONTRIBUTING.md': 'contribute/contributing.md',
  'SECURITY.md': 'contribute/security.md',
  'apps/docs/README.md': 'contribute/site.md',
  'apps/lab/README.md': 'tools/lab.md',
  'apps/viewer/README.md': 'tools/viewer.md',
  'docs/accuracy.md': 'hood/accuracy.md',
  'docs/browsers.md': 'hood/browsers.md',
  ...Object.fromEntries(DECISIONS.map(({ path, page }) => [path, page])),
  'docs/dependencies.md': 'contribute/dependencies.md',
  'docs/detail.md': 'guides/level-of-detail.md',
  'docs/effects.md': 'guides/write-an-effect.md',
  'docs/faults.md': 'contribute/faults.md',
  'docs/formats.md': 'hood/formats.md',
  'docs/framing.md': 'hood/framing.md',
  'docs/glossary.md': 'contribute/glossary.md',
  'docs/hard-cases.md': 'hood/correctness.md',
  'docs/benchmarks.md': 'hood/benchmarks.md',
  'docs/bricks.md': 'hood/bricks.md',
  'docs/frames.md': 'hood/frames.md',
  'docs/streamed-scenes.md': 'hood/streamed-scenes.md',
  'docs/releasing.md': 'contribute/releasing.md',
  'docs/tests.md': 'contribute/tests.md',
  'docs/three.md': 'contribute/three.md',
  'packages/cli/README.md': 'tools/cli.md',
  'packages/core/README.md': 'packages/core.md',
  'packages/core/src/clouds/README.md': 'contribute/clouds.md',
  'packages/core/src/frame/README.md': 'contribute/frame.md',
  'packages/core/src/gpu/README.md': 'contribute/gpu.md',
  'packages/core/src/gpu/effects/README.md': 'contribute/effects.md',
  'packages/core/src/io/README.md': 'contribute/io.md',
  'packages/core/src/views/README.md': 'contribute/views.md',
  'packages/react/README.md': 'packages/react.md',
  'packages/scenes/README.md': 'packages/scenes.md',
  'packages/three/README.md': 'packages/three.md',
};

export interface Section {
  readonly text: string;
  readonly pages: readonly { readonly text: string; readonly page: string }[];
}

/** Sidebar contents, except examples, API and evidence, which are generated. */
export const SECTIONS: readonly Section[] = [
  {
    text: 'Learn',
    pages: [
      { text: 'Quick start', page: 'learn/quick-start.md' },
      { text: 'Get a scene', page: 'learn/get-a-scene.md' },
      { text: 'Camera and orientation', page: 'learn/camera.md' },
      { text: 'Which API do I need?', page: 'learn/which-api.md' },
      { text: 'Troubleshooting', page: 'learn/troubleshooting.md' },
      { text: 'Migrate from other libraries', page: 'learn/migrate.md' },
    ],
  },
  {
    text: 'Guides',
    pages: [
      { text: 'Loading and progress', page: 'guides/loading.md' },
      { text: 'Streaming large scenes', page: 'guides/streaming.md' },
      { text: 'Level of detail', page: 'guides/level-of-detail.md' },
      { text: 'Effects', page: 'guides/effects.md' },
      { text: 'Write an effect', page: 'guides/write-an-effect.md' },
      { text: 'Depth and transparency', page: 'guides/depth.md' },
      { text: 'Shadows and light', page: 'guides/shadows.md' },
      { text: 'Events and picking', page: 'guides/events.md' },
      { text: 'Labels and measuring', page: 'guides/labels.md' },
      { text: 'Instances', page: 'guides/instances.md' },
      { text: 'Moving scenes', page: 'guides/moving-scenes.md' },
      { text: 'Sequences', page: 'guides/sequences.md' },
      { text: 'Own data, edits, morphs and bones', page: 'guides/own-data.md' },
      { text: 'Post-processing', page: 'guides/post-processing.md' },
      { text: 'Several cameras and XR', page: 'guides/xr.md' },
      { text: 'Saving and converting', page: 'guides/saving.md' },
      { text: 'Bounds and physics', page: 'guides/physics.md' },
      { text: 'drei', page: 'guides/drei.md' },
      { text: 'Testing your components', page: 'guides/testing.md' },
    ],
  },
  {
    text: 'Shipping',
    pages: [
      { text: 'Next.js, servers and posters', page: 'shipping/next.md' },
      { text: 'Bundlers and workers', page: 'shipping/bundlers.md' },
      { text: 'Hosting', page: 'shipping/hosting.md' },
      { text: 'Performance', page: 'shipping/performance.md' },
      { text: 'Errors and fallbacks', page: 'shipping/errors.md' },
    ],
  },
  {
    text: 'Packages',
    pages: [
      { text: '@websplatter/react', page: 'packages/react.md' },
      { text: '@websplatter/three', page: 'packages/three.md' },
      { text: '@websplatter/core', page: 'packages/core.md' },
      { text: '@websplatter/scenes', page: 'packages/scenes.md' },
    ],
  },
  {
    text: 'Under the hood',
    pages: [
      { text: 'How a frame is rendered', page: 'hood/frame.md' },
      { text: 'Correctness', page: 'hood/correctness.md' },
      { text: 'Accuracy presets', page: 'hood/accuracy.md' },
      { text: 'Accuracy on your device', page: 'hood/accuracy-here.md' },
      { text: 'Benchmarks', page: 'hood/benchmarks.md' },
      { text: 'File formats', page: 'hood/formats.md' },
      { text: 'Streamed scenes', page: 'hood/streamed-scenes.md' },
      { text: 'The .bricks format', page: 'hood/bricks.md' },
      { text: 'The .frames format', page: 'hood/frames.md' },
      { text: 'First cameras', page: 'hood/framing.md' },
      { text: 'Browsers', page: 'hood/browsers.md' },
    ],
  },
  {
    text: 'Tools',
    pages: [
      { text: 'Viewer', page: 'tools/viewer.md' },
      { text: 'Command line', page: 'tools/cli.md' },
      { text: 'Lab', page: 'tools/lab.md' },
    ],
  },
  {
    text: 'Contribute',
    pages: [
      { text: 'Contributing', page: 'contribute/contributing.md' },
      { text: 'Architecture', page: 'contribute/architecture.md' },
      { text: 'Tests', page: 'contribute/tests.md' },
      { text: 'Add a format', page: 'contribute/add-a-format.md' },
      { text: 'Debug a picture', page: 'contribute/debug-a-picture.md' },
      { text: 'Glossary', page: 'contribute/glossary.md' },
      { text: 'File reading', page: 'contribute/io.md' },
      { text: 'Device, shaders and stages', page: 'contribute/gpu.md' },
      { text: 'Effects and automatic features', page: 'contribute/effects.md' },
      { text: 'Clouds on the GPU', page: 'contribute/clouds.md' },
      { text: 'Inside a frame', page: 'contribute/frame.md' },
      { text: 'Views', page: 'contribute/views.md' },
      { text: 'Inside three.js and React', page: 'contribute/three.md' },
      { text: 'Failure modes', page: 'contribute/faults.md' },
      { text: 'This site', page: 'contribute/site.md' },
      { text: 'Dependencies', page: 'contribute/dependencies.md' },
      { text: 'Versions and releases', page: 'contribute/releasing.md' },
      { text: 'Security', page: 'contribute/security.md' },
      { text: 'Changelog', page: 'contribute/changelog.md' },
    ],
  },
  { text: 'Decisions', pages: DECISIONS },
];

const USER_SECTIONS = ['Learn', 'Guides', 'Shipping', 'Under the hood', 'Tools'];

/** Sidebar sections by a page's folder. Collapsible groups would nest buttons. */
export const SIDEBARS: Readonly<Record<string, readonly string[]>> = {
  '/learn/': USER_SECTIONS,
  '/guides/': USER_SECTIONS,
  '/shipping/': USER_SECTIONS,
  '/hood/': USER_SECTIONS,
  '/tools/': USER_SECTIONS,
  '/packages/': ['Packages'],
  '/examples/': ['Examples'],
  '/api/': ['API'],
  '/contribute/': ['Contribute', 'Decisions', 'Evidence'],
  '/evidence/': ['Contribute', 'Decisions', 'Evidence'],
};
