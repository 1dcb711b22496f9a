import type { View } from "../main"; export const showSubmit: View = async (host) => { host.append("submit"); };
