// Builds the viewer as one file, embed.html: scripts, styles, icon and workers are written into the
// page, which then works from a disk, in a frame, and wherever a single file can be put. Of the
// built-in scenes it has the small one alone, by the names of both: the other is several times as
// large as all the rest.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { mergeConfig, type Plugin } from 'vite';
import viewer from './vite.config.ts';

const SMALL_SCENE = createRequire(import.meta.url).resolve('@websplatter/scenes/files/still-life-small.spz');

export default mergeConfig(viewer, {
  define: { 'import.meta.env.WEBSPLATTER_ALONE': 'true' },
  plugins: [inlineFiles(), onePage()],
  worker: {
    // A classic script needs no address of its own.
    format: 'iife',
    plugins: () => [inlineFiles()],
    rolldownOptions: { output: { codeSplitting: false } },
  },
  build: {
    // It lies beside the viewer of many files.
    emptyOutDir: false,
    cssCodeSplit: false,
    rolldownOptions: { output: { codeSplitting: false } },
    // It is large because everything is in it.
    chunkSizeWarningLimit: Number.POSITIVE_INFINITY,
  },
});

/** Has workers started from text within the script, and scenes read from it, instead of files. */
function inlineFiles(): Plugin {
  return {
    name: 'websplatter:inline-files',
    enforce: 'pre',
    transform(code, id) {
      if (!/\.tsx?$/.test(id) || !code.includes('import.meta.url')) return null;
      const before = new Set<string>();
      const replaced = code
        .replace(/new URL\('[^']+\.(?:sog|spz)', import\.meta\.url\)/g, () => {
          const bytes = readFileSync(SMALL_SCENE, 'base64');
          before.add(`const smallScene = 'data:application/octet-stream;base64,${bytes}';`);
          return 'new URL(smallScene)';
        })
        .replace(
          /new Worker\(\s*new URL\('([^']+)', import\.meta\.url\),\s*\{[^}]*\}\s*,?\s*\)/g,
          (_, path) => {
            const name = `InlineWorker${before.size}`;
            before.add(`import ${name} from '${path}?worker&inline';`);
            return `new ${name}()`;
          },
        );
      if (replaced.includes('import.meta.url'))
        this.error(`${id}: a file is named in another form than the plugin knows`);
      // On one line, so that the others keep their places.
      return { code: [...before].join(' ') + replaced, map: null };
    },
  };
}

/** Writes the script, the styles and the icon into the page, which is all that is left. */
function onePage(): Plugin {
  return {
    name: 'websplatter:one-page',
    enforce: 'post',
    generateBundle: {
      // After Vite's own plugins have completed the scripts.
      order: 'post',
      handler(_, bundle) {
        const page = bundle['index.html'];
        if (page?.type !== 'asset') this.error('There is no page.');
        let html = String(page.source);
        const inline = (pattern: RegExp, write: (text: string) => string) => {
          const [tag, name] = pattern.exec(html) ?? this.error(`The page has nothing like ${pattern}.`);
          const file = bundle[name];
          const text = file.type === 'chunk' ? file.code : String(file.source);
          // A function, whose result is inserted verbatim.
          html = html.replace(tag, () => write(text));
          delete bundle[name];
        };
        inline(/<script type="module" crossorigin src="\.\/([^"]+)"><\/script>/, (script) => {
          // These would end the script, or hide its end.
          const safe = script.replace(/<(\/script|!--)/gi, (_tag, end) => `<\\${end}`);
          return `<script type="module">${safe}</script>`;
        });
        inline(/<link rel="stylesheet" crossorigin href="\.\/([^"]+)">/, (css) => `<style>${css}</style>`);
        inline(/<link rel="icon" href="\.\/([^"]+)" \/>/, (svg) => {
          return `<link rel="icon" href="data:image/svg+xml,${encodeURIComponent(svg)}" />`;
        });
        delete bundle['index.html'];
        const rest = Object.keys(bundle);
        if (rest.length > 0) this.error(`Besides the page there are still ${rest.join(', ')}.`);
        this.emitFile({ type: 'asset', fileName: 'embed.html', source: html });
      },
    },
  };
}
