import { readFileSync } from 'node:fs';
import { mergeConfig, type Plugin, type UserConfig } from 'vite';
import { LICENSES_ADDRESS } from './src/state/licenses-address.ts';
import viewer from './vite.config.ts';

export interface OneFileOptions {
  /** Path of the page in the viewer's folder. */
  readonly page: string;
  /** Name of the output file. */
  readonly fileName: string;
  /** Path of the file for all built-in scenes; null: none can be opened. */
  readonly scene: string | null;
}

/**
 * The viewer's build, changed so that a page is one file with scripts, styles, icon and workers.
 */
export function oneFile(options: OneFileOptions): UserConfig {
  return mergeConfig(viewer, {
    define: { 'import.meta.env.WEBSPLATTER_ALONE': 'true' },
    plugins: [inlineFiles(options), onePage(options)],
    worker: {
      // A classic script needs no URL of its own.
      format: 'iife',
      plugins: () => [inlineFiles(options)],
      rolldownOptions: { output: { codeSplitting: false } },
    },
    build: {
      // Written beside the viewer of many files.
      emptyOutDir: false,
      cssCodeSplit: false,
      rolldownOptions: { input: options.page, output: { codeSplitting: false } },
      // It is large because it contains everything.
      chunkSizeWarningLimit: Number.POSITIVE_INFINITY,
    },
  });
}

/** Embeds workers and built-in scenes as text in the script, instead of files. */
function inlineFiles({ scene }: OneFileOptions): Plugin {
  return {
    name: 'websplatter:inline-files',
    enforce: 'pre',
    // A single file has no page beside it.
    load: (id) => (id === '\0virtual:scene-page' ? "export default ''" : null),
    transform(code, id) {
      if (!/\.tsx?$/.test(id) || !code.includes('import.meta.url')) return null;
      const before = new Set<string>();
      const replaced = code
        .replace(/new URL\('[^']+\.(?:sog|spz)', import\.meta\.url\)/g, () => {
          const bytes = scene === null ? '' : readFileSync(scene, 'base64');
          before.add(`const inlineScene = 'data:application/octet-stream;base64,${bytes}';`);
          return 'new URL(inlineScene)';
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
      // On one line, so that other lines keep their numbers.
      return { code: [...before].join(' ') + replaced, map: null };
    },
  };
}

/**
 * Embeds scripts, styles, icon and third-party licences into the page, the only file that is left.
 */
function onePage({ page: name, fileName }: OneFileOptions): Plugin {
  return {
    name: 'websplatter:one-page',
    enforce: 'post',
    generateBundle: {
      // After Vite's own plugins have completed the scripts.
      order: 'post',
      handler(_, bundle) {
        const page = bundle[name];
        if (page?.type !== 'asset') this.error('There is no page.');
        let html = String(page.source);
        const inline = (pattern: RegExp, write: (text: string) => string) => {
          const [tag, path] = pattern.exec(html) ?? this.error(`The page has nothing like ${pattern}.`);
          const file = bundle[path];
          const text = file.type === 'chunk' ? file.code : String(file.source);
          // A function, so that its result is inserted verbatim.
          html = html.replace(tag, () => write(text));
          delete bundle[path];
        };
        inline(/<script type="module" crossorigin src="\.\/([^"]+)"><\/script>/, (script) => {
          // These sequences would end the script or hide its end.
          const safe = script.replace(/<(\/script|!--)/gi, (_tag, end) => `<\\${end}`);
          return `<script type="module">${safe}</script>`;
        });
        inline(/<link rel="stylesheet" crossorigin href="\.\/([^"]+)">/, (css) => `<style>${css}</style>`);
        inline(/<link rel="icon" href="\.\/([^"]+)" \/>/, (svg) => {
          return `<link rel="icon" href="data:image/svg+xml,${encodeURIComponent(svg)}" />`;
        });
        const licenses = bundle[LICENSES_ADDRESS];
        // Two hyphens would end the comment.
        if (licenses?.type === 'asset')
          html += `<!--\n${String(licenses.source).replaceAll('--', '==')}-->\n`;
        delete bundle[LICENSES_ADDRESS];
        delete bundle[name];
        const rest = Object.keys(bundle);
        if (rest.length > 0) this.error(`Besides the page there are still ${rest.join(', ')}.`);
        this.emitFile({ type: 'asset', fileName, source: html });
      },
    },
  };
}
