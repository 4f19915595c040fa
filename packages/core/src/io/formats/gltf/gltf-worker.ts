import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { openFiles } from '../../sources/open-files.ts';
import { onlyOf } from '../splat-format.ts';
import { readGltf } from './gltf.ts';
import { gltfFormat } from './gltf-format.ts';

serveLoad(self as unknown as LoadPort, { ...onlyOf(gltfFormat, readGltf), openFiles });
