import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { type DefaultTheme, defineConfig } from 'vitepress';
import { SIDEBARS } from './build/contents.ts';
import type { SiteContents } from './build/site-contents.ts';
import { slug } from './build/slug.ts';

// Written by the build.
const { sections } = JSON.parse(
  readFileSync(fileURLToPath(new URL('../.site/contents.json', import.meta.url)), 'utf8'),
) as SiteContents;

/** Path that the site is served under; VitePress adds it to links in pages, but not in `head`. */
const base = process.env.WEBSPLATTER_DOCS_BASE ?? '/';

function sidebarSection(name: string): DefaultTheme.SidebarItem {
  const { text, pages } = sections.find((section) => section.text === name)!;
  return {
    text,
    items: pages.map((page) => ({ text: page.text, link: `/${page.page.replace(/(?:index)?\.md$/, '')}` })),
  };
}

export default defineConfig({
  base,
  srcDir: '.site',
  outDir: 'dist',
  lang: 'en',
  title: 'WebSplatter',
  description: 'Gaussian splats on WebGPU, for React, three.js and plain pages.',
  lastUpdated: false,
  metaChunk: true,
  // Anchors are checked too, by the build itself.
  ignoreDeadLinks: false,
  head: [
    ['meta', { name: 'color-scheme', content: 'light dark' }],
    ['link', { rel: 'icon', href: `${base}icon.svg` }],
  ],
  vite: { build: { chunkSizeWarningLimit: 2000 } },
  markdown: {
    anchor: { slugify: slug },
    config({ renderer, utils }) {
      // Pages become Vue templates, in which double braces are expressions. VitePress already
      // escapes code blocks.
      for (const rule of ['text', 'code_inline'] as const) {
        const render = renderer.rules[rule] ?? ((tokens, index) => utils.escapeHtml(tokens[index].content));
        renderer.rules[rule] = (...args) => render(...args).replaceAll('{{', '&#123;&#123;');
      }
    },
    theme: { light: 'github-light-high-contrast', dark: 'github-dark-high-contrast' },
  },
  vue: { template: { compilerOptions: { isCustomElement: (tag) => tag.startsWith('ws-') } } },
  themeConfig: {
    nav: [
      { text: 'Learn', link: '/learn/quick-start', activeMatch: '/learn/' },
      { text: 'Guides', link: '/guides/loading', activeMatch: '/(?:guides|shipping)/' },
      { text: 'Examples', link: '/examples/', activeMatch: '/examples/' },
      { text: 'API', link: '/api/', activeMatch: '/api/' },
      { text: 'Internals', link: '/hood/frame', activeMatch: '/(?:hood|tools)/' },
      { text: 'Contribute', link: '/contribute/contributing', activeMatch: '/(?:contribute|evidence)/' },
    ],
    sidebar: Object.fromEntries(
      Object.entries(SIDEBARS).map(([folder, names]) => [folder, names.map(sidebarSection)]),
    ),
    search: {
      provider: 'local',
      options: {
        _render(source, env, markdown) {
          // Contributors' pages would come before the guides.
          if (env.relativePath.startsWith('contribute/')) return '';
          // Reads the front matter, too.
          const html = markdown.render(source, env);
          if (env.frontmatter?.search === false) return '';
          const keywords = (env.frontmatter?.keywords ?? []) as readonly string[];
          // Other words for the page's subject belong to its first section.
          return html.replace('</h1>', `</h1>\n<p>${keywords.join(', ')}</p>`);
        },
        miniSearch: {
          // VitePress serializes both functions into the site: they must not use outer variables.
          options: {
            // “nextjs” finds Next.js.
            tokenize: (text) => [
              ...text.split(/[\n\r\p{Z}\p{P}]+/u),
              ...(text.match(/\w+\.js\b/g) ?? []).map((name) => name.replace('.', '')),
            ],
          },
          searchOptions: {
            // “getting” would find “setting”.
            fuzzy: (term: string) => (term.length < 8 ? false : 0.2),
            // Most readers look for guides, then for props; few for entry points of tests and tools.
            boostDocument: (id) => {
              if (/\/(?:learn|guides|shipping)\//.test(id)) return 6;
              if (/\/api\/react\/(?:interfaces|functions)\//.test(id)) return 3;
              return /\/api\/\w+\/(?:inspect|measure|reference)\//.test(id) ? 0.3 : 1;
            },
          },
        },
      },
    },
    notFound: { linkLabel: 'Take me home', linkText: 'Take me home' },
    outline: { level: [2, 3] },
    externalLinkIcon: true,
  },
});
