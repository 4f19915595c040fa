import { fileURLToPath } from 'node:url';
import config from '../three/vite.config.ts';

// Built as that page is.
export default { ...config, root: fileURLToPath(new URL('.', import.meta.url)) };
