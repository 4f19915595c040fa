import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { readGltf } from './gltf.ts';
import { gltfFormat } from './gltf-format.ts';

serveLoad(self as unknown as LoadPort, gltfFormat, readGltf);
