import { expect, test } from 'vitest';
import { MUTATIONS } from './mutations.ts';

const shaders = import.meta.glob<string>(
  ['../../../shaders/lib/*.wgsl', '../../core/src/{stages,features}/*/*.wgsl'],
  {
    query: '?raw',
    import: 'default',
    eager: true,
  },
);

// A shader without the line does not compile, and a case that fails for that proves nothing.
test.each(MUTATIONS)('$remedy replaces a line that occurs once', ({ file, find }) => {
  const [folder, name] = file.split('/');
  const paths = Object.keys(shaders).filter(
    (path) => path.includes(`/${folder}/`) && path.endsWith(`/${name}.wgsl`),
  );
  expect(paths).toHaveLength(1);
  expect(shaders[paths[0]].split(find)).toHaveLength(2);
});
