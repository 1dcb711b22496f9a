import type { View } from "../main"; export const showJob: View = async (host) => { host.append("job"); };
