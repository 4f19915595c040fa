import { readFileSync } from 'node:fs';

/**
 * A plugin for Vite that strips comments and indentation from the shaders: a third of their bytes,
 * which no bundler can remove later.
 */
export function slimShaders() {
  return {
    name: 'websplatter:slim-shaders',
    enforce: 'pre',
    load(id) {
      if (!id.endsWith('.wgsl?raw')) return null;
      const text = readFileSync(id.slice(0, -'?raw'.length), 'utf8');
      if (text.includes('/*')) this.error(`${id}: only line comments are supported here`);
      const lines = text.split('\n').map((line) =>
        line
          .replace(/\/\/.*$/, '')
          .trim()
          .replace(/ *([{}(),;:=*/<>&|%!^[\]]) */g, '$1')
          // Two + or - in a row would be another operator.
          .replace(/(?<![-+]) *([-+]) *(?![-+])/g, '$1'),
      );
      const slim = lines
        .filter((line) => line !== '')
        .join('\n')
        .replace(/([{}(),;])\n|\n([})])/g, '$1$2');
      return `export default ${JSON.stringify(slim)};`;
    },
  };
}
